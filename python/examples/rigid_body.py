# %% [markdown]
# # A rigid body with noise
# A scene of the gallery: Euler's equations with three noises that do not commute.

# %%
import casimir

body = casimir.scene("rigid-body")
body.inspect()

# %%
run = body.run(paths=2000)
run.plot("law-C")

# %% [markdown]
# The figure above has the Casimir ½|y|² on its conformal law. Expectations come with intervals that
# have the bias of the steps in them.

# %%
found = body.expect(of=["y3", "cos(y3)"], accuracy=1e-4)
print(found["cos(y3)"].value, "±", found["cos(y3)"].half_width)
found

# %% [markdown]
# How fast do the errors of a scheme fall?

# %%
order = body.order(scheme="sexp-levy", path_steps=2e7)
order.plot("strong")
