"""`solar-env study figures`: documentation pictures of a deployment, of failing time steps, and of a design study."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from solar_env.commands import design
from solar_env.commands.study import Args
from solar_env.environment.registration import DEPLOY_V1
from solar_env.support.files import write_bytes, writing
from solar_env.support.progress import counting_bar
from solar_env.support.readme import PACKAGE, STUDIES

OPTIONS = ("out", "readme")
# Time of the frame, after latching.
FRAME_TIME = 13.6  # s


def draw_frame(path: Path) -> None:
    """Draw a frame of a deployment by the springs alone, after latching, and write it to `path` as PNG."""
    import gymnasium
    from PIL import Image

    env = gymnasium.make(DEPLOY_V1, render_mode="rgb_array")
    env.reset(seed=0)
    for _ in range(round(FRAME_TIME / 0.1)):
        env.step(np.zeros(1, dtype=np.float32))
    with writing(path) as file:
        Image.fromarray(np.asarray(env.render())).save(file, "png", optimize=True)


def draw_deployment(path: Path) -> None:
    """Plot angles, forces, torques, energies, journal paths and wear of the default deployment to the file `path`."""
    from solar_env.array.deployment import simulate
    from solar_env.pictures.plots import plot_deployment

    plot_deployment(simulate(), path)


def draw_stability(path: Path) -> None:
    """Measure at which fixed step sizes generalized-alpha fails on impacts, and draw the map to the file `path`."""
    from solar_env.studies.stability.stability_maps import measure_map
    from solar_env.studies.stability.stability_plot import draw_map

    with TemporaryDirectory() as folder:
        table = Path(folder) / "map.csv"
        measure_map("impact-implicit", False, table, lambda: None)
        draw_map(table, path)


def draw_design(path: Path) -> None:
    """Plot the latch torque of the default array against the damping of hinges and latches, to the file `path`."""
    with TemporaryDirectory() as folder:
        design.run_command(design.Args(keep=["latch_time < 30"], points=36, out=Path(folder)))
        write_bytes(path, (Path(folder) / design.PICTURE).read_bytes())


_OWN = PACKAGE / "pictures" / "figures"
# Picture file -> function that draws the file.
PICTURES = {
    _OWN / "frame.png": draw_frame,
    _OWN / "deployment.png": draw_deployment,
    STUDIES / "stability" / "figures" / "stability.png": draw_stability,
    STUDIES / "design" / "figures" / "design.png": draw_design,
}


def run(args: Args) -> int:
    """Draw a deployment, a map of failing time steps, a design study.

    The map shows fixed step sizes at which generalized-alpha fails. The design study varies the damping of hinges.
    """
    folder, _ = args.folders("figures")
    paths = {place if args.readme else folder / place.name: draw for place, draw in PICTURES.items()}
    with counting_bar(args.console) as bar:
        for path, draw in bar.track(paths.items(), description="pictures"):
            draw(path)
    print(*paths, sep="\n")
    return 0
