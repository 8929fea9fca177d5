"""torchsde 0.2.6: `milstein` with scalar noise in two dimensions has a wrong second term.

dy = Jy ∘ dW with J = [[0, 1], [-1, 0]] turns y, so |y(1)| = |y(0)| = 1, and y(1) is known:
(cos W, −sin W). The term of Milstein's method is ½ Σⱼ gⱼ ∂ⱼgᵢ ΔW², a product with the Jacobian of g.
`g_prod_and_gdg_prod_default` takes the vector–Jacobian product ½ Σⱼ gⱼ ∂ᵢgⱼ ΔW² instead: the
transposed Jacobian. Both agree in one dimension and for gradients g.

    pip install torchsde
    python torchsde_milstein.py
"""

import torch
import torchsde

torch.set_default_dtype(torch.float64)


class Turn(torch.nn.Module):
    sde_type, noise_type = "stratonovich", "scalar"

    def f(self, t, y):
        return 0 * y

    def g(self, t, y):
        return torch.stack([y[:, 1], -y[:, 0]], dim=1).unsqueeze(2)


for steps in (64, 256, 1024):
    y0 = torch.tensor([[1.0, 0.0]]).repeat(1000, 1)
    bm = torchsde.BrownianInterval(0.0, 1.0, size=(1000, 1), dtype=torch.float64, entropy=1)
    w = bm(0.0, 1.0)[:, 0]
    exact = torch.stack([torch.cos(w), -torch.sin(w)], dim=1)
    for method, options in [("milstein", {}), ("milstein", {"grad_free": True}), ("heun", {})]:
        y = torchsde.sdeint(
            Turn(), y0, torch.tensor([0.0, 1.0]), bm=bm, method=method, dt=1 / steps, options=dict(options)
        )[-1]
        error = (y - exact).square().sum(1).mean().sqrt().item()
        print(f"{steps:5} steps  {method:9}{'grad_free' if options else '':10}  error {error:.4f}")
