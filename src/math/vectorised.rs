//! One source for all processors.

/// A function compiled several times, for plain x86-64 (or whatever the target is), AVX2 and AVX-512; which one runs
/// is decided at run time.
///
/// All do the same arithmetic: Rust never fuses or reorders floating-point operations by itself, and `mul_add` is fused
/// everywhere, so that the same bits come out. Where it is not inlined into such a function it is slow. The body is a
/// function of its own, since a closure that is compiled for one processor is not inlined into the standard library's
/// loops.
macro_rules! vectorised {
    (
        $(#[$meta:meta])*
        $vis:vis fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? $body:block
    ) => {
        $(#[$meta])*
        #[multiversion::multiversion(targets(
            "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma+bmi1+bmi2+popcnt+lzcnt",
            "x86_64+avx2+fma+bmi1+bmi2+popcnt+lzcnt"
        ))]
        $vis fn $name($($argument: $type),*) $(-> $result)? {
            #[inline(always)]
            fn everywhere($($argument: $type),*) $(-> $result)? $body
            everywhere($($argument),*)
        }
    };
}

pub(crate) use vectorised;
