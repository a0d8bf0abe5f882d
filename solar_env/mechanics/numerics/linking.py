"""Numba's compiler for kernels that only other kernels call: these end up inside their callers' machine code.

Numba optimizes every function fully and translates it to machine code of its own, even where all its callers inline it.
For the kernels of a method that was a third of the time to compile it.
"""

from typing import Any

from numba import _dynfunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering


class LinkedLibrary(JITCodeLibrary):
    """Code of a kernel that is optimized lightly, for its callers to link, and that has no machine code of its own."""

    def _optimize_final_module(self) -> None:
        passes, builder = self._codegen._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=self._codegen._opt_level, cost="cheap"
        )
        passes.run(self._final_module, builder)

    def _finalize_final_module(self) -> None:
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class LinkedLowering(NativeLowering):
    """Translation of a kernel into code to link, known to its callers by an object that Python cannot call."""

    _name = "linked_lowering"

    def run_pass(self, state: Any) -> bool:
        """Translate the kernel, and tell the compiler of its callers where its code is."""
        state.library = LinkedLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.flags.no_compile = True
        super().run_pass(state)
        lowered = state["cr"]
        about = lowered.fndesc
        key = _dynfunc.make_function(about.lookup_module(), about.qualname, "", 0, lowered.env, (state.library,))
        state.targetctx.insert_user_function(key, about, [state.library])
        state["cr"] = lowered._replace(cfunc=key)
        return True


class LinkedCompiler(CompilerBase):
    """Numba's compiler, with the last translation replaced by `LinkedLowering`."""

    def define_pipelines(self) -> list[Any]:
        """Return the one list of passes."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(LinkedLowering, NativeLowering)
        passes.passes = [row for row in passes.passes if row[0] is not NativeLowering]
        passes.finalize()
        return [passes]
