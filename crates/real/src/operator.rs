//! The operators of number types.

/// Implements operators, always inlined.
macro_rules! operators {
    ([$($generics:tt)*] $number:ty:) => {};
    ([$($generics:tt)*] $number:ty:
        $operator:ident::$method:ident($a:ident $(, $b:ident: $other:ty)?) => $value:expr;
        $($more:tt)*) => {
        impl<$($generics)*> $operator$(<$other>)? for $number {
            type Output = Self;
            #[inline(always)]
            fn $method(self $(, $b: $other)?) -> Self {
                let $a = self;
                $value
            }
        }
        operators!([$($generics)*] $number: $($more)*);
    };
}
pub(crate) use operators;
