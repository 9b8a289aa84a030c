//! The list of elements: a new one is a file in `elements/` and a line here.

use crate::structure::elements::force_deflection::ForceDeflection;
use crate::structure::elements::plastic_spring::PlasticSpring;
use crate::structure::elements::secant::{Damper, Spring};
use crate::structure::elements::series_spring_damper::SeriesSpringDamper;
use crate::structure::law::Law;

macro_rules! elements {
    ($($(#[$doc:meta])* $element:ident),+ $(,)?) => {
        /// What joins two nodes of a [`Structure`](crate::Structure).
        #[derive(Debug, Clone, PartialEq)]
        pub enum Element {
            $($(#[$doc])* $element($element),)+
        }

        impl Element {
            /// What it says of itself.
            pub(crate) fn law(&self) -> &dyn Law {
                match self {
                    $(Self::$element(element) => element,)+
                }
            }
        }

        $(impl From<$element> for Element {
            fn from(element: $element) -> Self {
                Self::$element(element)
            }
        })+
    };
}

elements! {
    /// A spring, linear or with knots.
    Spring,
    /// A damper, linear or with knots.
    Damper,
    /// A linear spring and a linear damper in series.
    SeriesSpringDamper,
    /// A spring that unloads stiffer than it loads, about a permanent set.
    PlasticSpring,
    /// A structure that is crushed: a curve of force over deflection with an unloading stiffness.
    ForceDeflection,
}
