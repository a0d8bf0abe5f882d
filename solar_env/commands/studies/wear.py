"""`solar-env study wear`: a hundred deployments, whose clearances grow by the wear of earlier deployments."""

from solar_env.commands.study import Args
from solar_env.support.readme import STUDIES

OPTIONS = ("out", "readme", "draw", "quick", "jobs")
QUICK = 3  # number of deployments in a quick run


def run(args: Args) -> int:
    """Repeat a hundred deployments with the worn clearance fed back."""
    from solar_env.studies.common.tables import provenance, read_table, write_table
    from solar_env.studies.wear import repeated
    from solar_env.studies.wear.plot import draw_repeated

    tables, pictures = args.folders("wear", None, STUDIES / "wear" / "figures")
    path = tables / repeated.FILE
    if not args.draw:
        deployments = QUICK if args.quick else repeated.DEPLOYMENTS
        rows = repeated.measure_repeated(deployments, args.workers, args.console)
        write_table(path, rows, provenance(args.command))
        print(path)
    print(draw_repeated(read_table(path), pictures))
    return 0
