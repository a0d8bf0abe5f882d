"""Compiler for kernels that only other kernels call, and whose code becomes part of their callers' machine code.

Numba by itself optimizes every function fully and translates it to separate machine code, even if all callers inline
the function. For the kernels of an integration method, this took a third of the compilation time.
"""

from typing import Any

from numba import _dynfunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import register_pass
from numba.core.typed_passes import NativeLowering


class LinkedLibrary(JITCodeLibrary):
    """Lightly optimized code of a kernel, which its callers link; no separate machine code is made."""

    def _optimize_final_module(self) -> None:
        passes, builder = self._codegen._module_pass_manager(
            loop_vectorize=False, slp_vectorize=False, opt=self._codegen._opt_level, cost="cheap"
        )
        passes.run(self._final_module, builder)

    def _finalize_final_module(self) -> None:
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class LinkedLowering(NativeLowering):
    """Compiler pass that translates a kernel to code that compiled callers link, and that Python cannot call."""

    _name = "linked_lowering"

    def run_pass(self, state: Any) -> bool:
        """Translate the kernel, and register its code for the compilation of its callers."""
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
    """Numba's compiler with its native lowering pass replaced by `LinkedLowering`."""

    def define_pipelines(self) -> list[Any]:
        """Return a list with the only pipeline of compiler passes."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.add_pass_after(LinkedLowering, NativeLowering)
        passes.passes = [row for row in passes.passes if row[0] is not NativeLowering]
        passes.finalize()
        return [passes]
