//! Functions compiled for several instruction sets from one source.

/// Compiles a function several times: for the target's baseline (plain x86-64, for example), for AVX2 and for AVX-512.
/// The version that fits the processor is chosen at run time.
///
/// All versions return the same bits: Rust never fuses or reorders floating-point operations by itself, and `mul_add`
/// is fused everywhere. It is slow, however, outside such a function, where it may be a call.
///
/// The body becomes an inner function, since a closure that is compiled for one instruction set is not inlined into the
/// standard library's loops.
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
