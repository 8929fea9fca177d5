//! Equations that are given by drift and noise.

use crate::common::{fails, json, succeeds, with_scene};

/// A Kubo oscillator in Itô's sense.
const KUBO: &str = r#"[system]
state = ["q", "p"]
parameters = { s = 0.4, w = 2 }
B = "canonical"
H0 = "(q^2 + p^2)/2 - cos(w*t)*q"
H = ["s*(q^2 + p^2)/2"]
calculus = "ito"
drift = ["p - s^2/2*q - q*t/5", "cos(w*t) - q - s^2/2*p - t/5*p"]
noise = [["s*p", "-s*q"]]
[damping]
rate = "t/5"
[run]
initial = [1, 0]
until = 1
steps = 16
"#;

fn with(from: &str, to: &str) -> String {
    assert!(KUBO.contains(from), "{from}");
    KUBO.replace(from, to)
}

#[test]
fn an_equation_of_ito_is_converted_and_compared() {
    let folder = with_scene(KUBO);
    succeeds(folder.path(), &["run", "scene.toml"]);
    // The same in Stratonovich's sense.
    let same =
        with("\"ito\"", "\"stratonovich\"").replace("- s^2/2*q", "").replace("- s^2/2*p", "");
    let folder = with_scene(&same);
    succeeds(folder.path(), &["run", "scene.toml"]);
    // Nothing is required that is not there.
    let folder = with_scene(&same.replace("calculus = \"stratonovich\"\n", ""));
    succeeds(folder.path(), &["inspect", "scene.toml"]);
}

#[test]
fn what_is_not_of_this_form_is_named() {
    for (scene, words) in [
        (
            with("\"ito\"", "\"stratonovich\""),
            "line 8, column 10: this drift is -0.080000 at y = [1.0, 0.0], t = 0, and that of B and H is 0.000000 \
             in the sense of Stratonovich; Itô's ½Σ b′b is the difference: only equations of this form are \
             simulated. Theirs, of Stratonovich, is dq = p dt + 0.4 p ∘ dW1 - γ q dt",
        ),
        (
            with("p - s^2/2*q - q*t/5", "p - q*t/5"),
            "this drift is 0.000000 at y = [1.0, 0.0], t = 0, and that of B and H is -0.080000 in the sense of Itô; Itô's",
        ),
        (
            with("[[\"s*p\", \"-s*q\"]]", "[[\"s*q\", \"-s*q\"]]"),
            "this noise 1 is 0.400000 at y = [1.0, 0.0], t = 0, and that of B and H is 0.000000",
        ),
        (with("cos(w*t) - q", "cos(w*t) - 1.0000001*q"), "this drift is"),
        (with("noise = [[\"s*p\", \"-s*q\"]]\n", ""), "H has 1 noises, and `noise` has 0"),
        (
            with("noise = [[\"s*p\", \"-s*q\"]]", "noise = [[\"s*p\"]]"),
            "one formula for each of 2 components",
        ),
        (
            with("drift = [\"p - s^2/2*q - q*t/5\", \"cos(w*t) - q - s^2/2*p - t/5*p\"]\n", ""),
            "give its `drift` as well",
        ),
        (with("\"s*p\"", "\"s*r\""), "unknown name `r`"),
        (with("\"ito\"", "\"itô\""), "unknown variant `itô`"),
    ] {
        let folder = with_scene(&scene);
        fails(folder.path(), &["run", "scene.toml"], 2, &[words]);
        assert!(!folder.path().join("scene-run").exists());
    }
}

/// dx = f dt + g ∘dW is ẋ = ∂H/∂p with H₀ = pf and H₁ = pg; p stays 0. Here E[x] = e^{(r + s²/2)T}
/// is known, which e^{rT}, of an equation of Itô's, is far from.
#[test]
fn any_equation_has_momenta_that_stay_zero() {
    let folder = with_scene(
        "[system]\nstate = [\"x\", \"p\"]\nparameters = { r = 0.5, s = 0.4 }\nB = \"canonical\"\n\
         H0 = \"p*x*r\"\nH = [\"p*x*s\"]\n[run]\ninitial = [1, 0]\nuntil = 2\nsteps = 64\n\
         [expect]\nof = [\"x + 1e9*p\"]\naccuracy = 0.01\n",
    );
    let found = json(folder.path(), &["expect", "scene.toml", "--json"]);
    let [value, half_width] = ["value", "half_width"]
        .map(|key| found["estimates"][0][key].as_f64().unwrap_or_else(|| panic!("{found}")));
    let off = |exact: f64| (value - exact).abs();
    assert!(half_width <= 0.01 && off(1.16f64.exp()) <= half_width, "{value} ± {half_width}");
    assert!(off(1f64.exp()) > 10.0 * half_width, "{value} ± {half_width}");
}
