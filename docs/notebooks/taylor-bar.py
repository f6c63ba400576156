# %% [markdown]
# # A Taylor bar beside its experiment
#
# A copper cylinder strikes a rigid wall. Its final length and the diameter of its foot are the classic test of a flow law. Here the shipped deck
# `copper-bar` is run coarsely, and set beside the experiment of Johnson and Cook (1983) that it models.
# %%
import sphorge as sp

deck = sp.Deck("copper-bar")
print("\n".join(line for line in deck.text.splitlines() if line.startswith("#")))
# %% [markdown]
# A coarse run takes some seconds. The bar below the cell shows how far it is; the simulation goes on while its frames are asked for.
# %%
deck["particles.spacing"] = "0.8467 mm"
deck["output.frames"] = 6
for frame in sp.Simulation(deck, out="taylor", overwrite=True):
    print(f"{1e6 * frame.time:5.1f} us   largest plastic strain {frame['plastic_strain'].max():.3f}")
# %% [markdown]
# The run: how it ended, its measures, the last frame.
# %%
run = sp.Run("taylor")
run
# %% [markdown]
# ## Beside the experiment
#
# The comment of the deck quotes what was measured, and what finite elements give with the same constants on the same wall: what is between the last two is
# the flow law and the wall, what is between the run and finite elements is the method and its spacing.
# %%
length, diameter = 25.4e-3, 7.62e-3
got = {"length / first length": run.measures["length"] / length, "foot / diameter": run.measures["foot_diameter"] / diameter}
measured = {"length / first length": 0.638, "foot / diameter": 1.78}
elements = {"length / first length": 0.683, "foot / diameter": 1.91}
print(f"{'':22}  run    measured  finite elements")
for name, value in got.items():
    print(f"{name:22} {value:6.3f}  {measured[name]:6.3f}    {elements[name]:6.3f}")
# %% [markdown]
# ## Inside, and over time
# %%
run.plot("plastic_strain", view="xz", section=True, frames=["first", "last"], width="150 mm", dpi=80)
# %%
run.plot(column=["length", "foot_diameter"], width="130 mm", dpi=80)
# %% [markdown]
# How far the coarse particles are from a fine bar is a question for `sp.convergence`, which runs several spacings.
