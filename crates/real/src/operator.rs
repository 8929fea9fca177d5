//! The operators and functions of number types.

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

/// Functions of a number type, always inlined: of one number, or of arguments with their types.
macro_rules! functions {
    () => {};
    ($function:ident($a:ident) => $value:expr; $($more:tt)*) => {
        #[inline(always)]
        fn $function(self) -> Self {
            let $a = self;
            $value
        }
        functions! { $($more)* }
    };
    ($function:ident($($argument:ident: $type:ty),*) => $value:expr; $($more:tt)*) => {
        #[inline(always)]
        fn $function($($argument: $type),*) -> Self {
            $value
        }
        functions! { $($more)* }
    };
}
pub(crate) use {functions, operators};
