//! The operators of number types.

/// Implements one operator, always inlined.
macro_rules! operator {
    ([$($generics:tt)*] $number:ty:
        $operator:ident::$method:ident($a:ident $(, $b:ident: $other:ty)?) => $value:expr) => {
        impl<$($generics)*> $operator$(<$other>)? for $number {
            type Output = Self;
            #[inline(always)]
            fn $method(self $(, $b: $other)?) -> Self {
                let $a = self;
                $value
            }
        }
    };
}
pub(crate) use operator;
