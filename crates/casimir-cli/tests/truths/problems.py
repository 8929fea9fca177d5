"""The problems of `truths.toml`: scenes as a user would type them, and how each truth is known.

The equation is dy = (B∇H₀ − γ(t)y)dt + Σ B∇Hₘ ∘ dWₘ (Stratonovich).
"""

PAIR = '''[system]
state = ["q", "p"]
B = [["1"]]
'''
SPIN = '''[system]
state = ["s1", "s2", "s3"]
B = [["0", "-s3", "s2"], ["s3", "0", "-s1"], ["-s2", "s1", "0"]]
'''
SQUARES = 'q2 = "q^2"\np2 = "p^2"\nqp = "q*p"\nenergy = "H0"\n'


def run(initial, until, steps, paths, rest=""):
    return f"[run]\ninitial = {initial}\nuntil = {until}\nsteps = {steps}\npaths = {paths}\n{rest}"


def damped(rate):
    return f'[damping]\nrate = "{rate}"\n'


# Name, method of `truths.py`, its settings, scene.
PROBLEMS = []


def problem(name, method, scene, **settings):
    PROBLEMS.append((name, method, settings, scene))


problem(
    "driven oscillator, long",
    "linear",
    PAIR + 'H0 = "(p^2 + q^2)/2"\nH = ["0.05*q"]\n'
    + run("[1, 0]", 2000, 10000, 1000) + "[observe]\n" + SQUARES,
    check=(20000, 4000),
)
problem(
    "weakly damped oscillator, two noises",
    "linear",
    PAIR + 'H0 = "(p^2 + 9*q^2)/2"\nH = ["0.3*q", "0.2*p"]\n' + damped("0.02")
    + run("[1, 0]", 60, 3000, 1000) + "[observe]\n" + SQUARES,
    check=(6000, 10000),
)
problem(
    "strong damping, γτ = 5",
    "linear",
    PAIR + 'H0 = "(p^2 + q^2)/2"\nH = ["0.5*q"]\n' + damped("500")
    + run("[1, 0]", 1, 100, 1000) + "[observe]\n" + SQUARES,
    units=(2e-5, 1e-2, 1),
    check=(4000, 10000),
)
problem(
    "Kubo oscillator",
    "linear",
    PAIR + 'parameters = { w = 2, s = 0.5 }\nH0 = "w*(p^2 + q^2)/2"\nH = ["s*(p^2 + q^2)/2"]\n'
    + damped("0.1") + run("[1, 0]", 5, 500, 1000) + '[observe]\nq2 = "q^2"\nqp = "q*p"\n',
    check=(1000, 20000),
)
problem(
    "spin, noise in three directions",
    "linear",
    SPIN + 'H0 = "2*s3"\nH = ["0.5*s1", "0.5*s2", "0.5*s3"]\n' + damped("0.1")
    + run("[0.6, 0, 0.8]", 4, 400, 1000) + '[observe]\na = "s1^2"\nb = "s1*s2"\nc = "s2*s3"\n',
    check=(800, 20000),
)
problem(
    "spin, tilted field, two noises",
    "linear",
    SPIN + 'H0 = "s1 + 2*s3"\nH = ["0.7*s2", "0.4*s3"]\n'
    + run("[1, 0, 0]", 3, 150, 1000) + '[observe]\na = "s1^2"\nb = "s1*s3"\nenergy = "H0"\n',
    check=(600, 20000),
)
problem(
    "spin, fast precession, long steps",
    "linear",
    SPIN + 'H0 = "5*s3"\nH = ["0.3*s1"]\n'
    + run("[3, 0, 0]", 10, 200, 1000) + '[observe]\na = "s1^2"\nb = "s3^2"\nc = "s1*s2"\n',
    check=(4000, 10000),
)
problem(
    "chain of four oscillators, noise at one end",
    "linear",
    '''[system]
state = ["q1", "q2", "q3", "q4", "p1", "p2", "p3", "p4"]
B = [[0, 0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0], [0, 0, 0, 1, 0], [0, 0, 0, 1], [0, 0, 0], [0, 0], [0]]
H0 = """(p1^2 + p2^2 + p3^2 + p4^2)/2
  + (q1^2 + (q2 - q1)^2 + (q3 - q2)^2 + (q4 - q3)^2 + q4^2)/2"""
H = ["0.4*q1"]
''' + damped("0.05") + run("[0, 0, 0, 1, 0, 0, 0, 0]", 40, 800, 1000) + '[observe]\nenergy = "H0"\n',
    check=(800, 10000),
)
problem(
    "Hénon–Heiles, chaotic, weak noise",
    "sampled",
    '''[system]
state = ["x", "y", "u", "v"]
B = [[0, 1, 0], [0, 1], [0]]
H0 = "(u^2 + v^2 + x^2 + y^2)/2 + x^2*y - y^3/3"
H = ["0.003*x", "0.003*y"]
''' + run('[0, 0.1, "sqrt(0.237)", 0]', 100, 2000, 1000) + '[observe]\nenergy = "H0"\nx2 = "x^2"\nmomentum = "x*v - y*u"\n',
    hamiltonian=(2000, 60000),
    energy=0.003**2,
)
problem(
    "pendulum, additive noise, long",
    "sampled",
    PAIR + 'H0 = "p^2/2 - cos(q)"\nH = ["0.1*q"]\n'
    + run("[2, 0]", 500, 5000, 500) + '[observe]\nenergy = "H0"\nheight = "-cos(q)"\np2 = "p^2"\n',
    hamiltonian=(10000, 20000),
    energy=0.5 * 0.1**2,
)
problem(
    "double well, damped",
    "sampled",
    PAIR + 'H0 = "p^2/2 + q^4/4 - q^2/2"\nH = ["0.5*q"]\n' + damped("0.2")
    + run("[1, 0]", 10, 200, 1000) + '[observe]\nq2 = "q^2"\nqp = "q*p"\nenergy = "H0"\n',
    grid=True,
    check=(400, 100000),
)
problem(
    "oscillator with a fluctuating spring",
    "linear",
    PAIR + 'H0 = "(p^2 + q^2)/2"\nH = ["0.3*q^2/2"]\n' + damped("0.05")
    + run("[1, 0]", 10, 500, 2000) + "[observe]\n" + SQUARES,
    check=(1000, 20000),
)
problem(
    "growth and decay with multiplicative noise",
    "linear",
    PAIR + 'H0 = "0.1*q*p"\nH = ["0.5*q*p"]\n'
    + run("[1, 1]", 1, 100, 2000) + '[observe]\nproduct = "q*p"\nq2 = "q^2"\n',
    check=(200, 40000),
)
problem(
    "rigid body, noise on its time, damping in time",
    "clock",
    '''[system]
state = ["y1", "y2", "y3"]
B = [["-y3", "y2"], ["-y1"]]
H0 = "y1^2/4 + y2^2/2 + 3*y3^2/4"
H = ["0.4*(y1^2/4 + y2^2/2 + 3*y3^2/4)"]
''' + damped("0.3 + 0.2*sin(3*t)") + run("[1, 1, 1]", 8, 400, 1000)
    + '[observe]\na = "y1*y2"\nb = "y3^2"\nenergy = "H0"\n',
    strength=0.4,
    homogeneous=True,
    check=(800, 20000),
)
problem(
    "predators and prey, noise on their time",
    "clock",
    '''[system]
state = ["x", "y"]
B = [["-x*y"]]
H0 = "x - ln(x) + y - ln(y)"
H = ["0.3*(x - ln(x) + y - ln(y))"]
''' + run("[1, 2]", 10, 500, 1000) + '[observe]\nlogarithm = "ln(x)"\nxy = "x*y"\nenergy = "H0"\n',
    strength=0.3,
    check=(1000, 20000),
)
problem(
    "damped pendulum without noise",
    "deterministic",
    PAIR + 'H0 = "p^2/2 - cos(q)"\n' + damped("0.2")
    + run("[2, 0]", 10, 100, 100) + '[observe]\nenergy = "H0"\nq2 = "q^2"\n',
)
problem(
    "ion in a trap, SI units",
    "linear",
    PAIR + 'parameters = { m = 1e-25, w = 6e6, s = 1e-23 }\nH0 = "p^2/(2*m) + m*w^2*q^2/2"\nH = ["s*q"]\n'
    + damped("2e4") + run('[1e-6, 0]', 2e-5, 2000, 1000) + "[observe]\n" + SQUARES,
    units=(1e-6, 6e-25, 1e6),
    check=(2000, 10000),
)
problem(
    "slow large oscillator",
    "linear",
    PAIR + 'parameters = { m = 1e3, w = 1e-5, s = 30 }\nH0 = "p^2/(2*m) + m*w^2*q^2/2"\nH = ["s*q"]\n'
    + run("[1e6, 0]", 2e6, 1000, 1000) + "[observe]\n" + SQUARES,
    units=(1e6, 1e4, 1e-5),
    check=(2000, 10000),
)
problem(
    "charge in a magnetic trap, a fluctuating electric field",
    "linear",
    '''[system]
state = ["x", "y", "u", "v"]
B = [[0, 1, 0], [0, 1], [2]]
H0 = "(u^2 + v^2)/2 + (x^2 + y^2)/4"
H = ["0.2*x"]
''' + damped("0.03") + run("[1, 0, 0, 0]", 30, 1200, 1000)
    + '[observe]\nenergy = "H0"\nxv = "x*v"\nr2 = "x^2 + y^2"\n',
    check=(1200, 10000),
)
problem(
    "Toda chain of three, long",
    "sampled",
    '''[system]
state = ["q1", "q2", "q3", "p1", "p2", "p3"]
B = [[0, 0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1], [0, 0], [0]]
H0 = "(p1^2 + p2^2 + p3^2)/2 + exp(q1 - q2) + exp(q2 - q3) + exp(q3 - q1)"
H = ["0.1*q1", "0.1*q2", "0.1*q3"]
''' + run("[0.5, 0, -0.5, 0, 0.5, -0.5]", 300, 3000, 100)
    + '[observe]\nenergy = "H0"\nmomentum = "p1 + p2 + p3"\np12 = "p1^2"\n',
    hamiltonian=(6000, 15000),
    energy=1.5 * 0.1**2,
    only=["energy", "momentum", "p1", "p2", "p3", "p12"],
)
problem(
    "oscillator that is damped and excited in turn",
    "linear",
    PAIR + 'H0 = "(p^2 + 4*q^2)/2"\nH = ["0.2*q"]\n' + damped("-0.2 + 0.5*cos(5*t)")
    + run("[1, 0]", 6, 600, 1000) + "[observe]\n" + SQUARES,
    check=(1200, 20000),
)
problem(
    "two frequencies, ωτ = 2 of the fast one",
    "linear",
    '''[system]
state = ["q", "Q", "p", "P"]
B = [[0, 1, 0], [0, 1], [0]]
H0 = "(p^2 + P^2)/2 + q^2/2 + 800*(Q - q/10)^2"
H = ["0.2*q"]
''' + damped("0.1") + run("[1, 0.1, 0, 0]", 10, 200, 1000)
    + '[observe]\nslow = "p^2 + q^2"\nfast = "P^2/2 + 800*(Q - q/10)^2"\nenergy = "H0"\n',
    check=(8000, 5000),
)
problem(
    "spins without exchange on a lattice",
    "lattice",
    '''[system]
name = "spin-lattice"
parameters = { sizes = [4], exchange = 0, field = [0, 0, 1], noise = 0.5 }
''' + damped("0.1") + run('["0.6", "0", "0.8"]', 3, 150, 1000),
)
problem(
    "three dimensions, constant B, a linear Casimir",
    "linear",
    '''[system]
state = ["x", "y", "z"]
B = [["1", "-1"], ["1"]]
H0 = "(x^2 + y^2 + 2*z^2)/2"
H = ["0.2*x", "0.1*z^2"]
''' + damped("0.1") + run("[1, 0, 0.5]", 10, 300, 1000)
    + '[observe]\ncasimir = "x + y + z"\nx2 = "x^2"\nyz = "y*z"\nenergy = "H0"\n',
    check=(600, 20000),
)
