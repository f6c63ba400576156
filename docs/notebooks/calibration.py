# %% [markdown]
# # Constants of a flow law from two Taylor bars
#
# `sp.calibrate` looks for values of keys with which the measures of a deck are those of experiments. Here the experiments are runs with constants that
# we know, so that we see whether they are found. The bars are plates in plane strain with few particles.
# %%
import sphorge as sp

A, B = "material.bar.strength.johnson-cook.A", "material.bar.strength.johnson-cook.B"
deck = sp.Deck(
    {
        "title": "Coarse Taylor bar",
        "dimensions": "plane-strain",
        "particles": {"spacing": "2 mm"},
        "time": {"end": "40 us"},
        "output": {"frames": 4},
        "material": {"bar": {"base": "armco-iron"}},
        "body": [
            {
                "name": "bar",
                "material": "bar",
                "shape": {"box": {"min": ["-4 mm", "0 mm"], "max": ["4 mm", "24 mm"]}},
                "velocity": ["0 m/s", "-200 m/s"],
            }
        ],
        "wall": [{"name": "anvil", "plane": {"point": ["0 mm", "0 mm"], "normal": [0, 1]}}],
        "measure": [{"name": "height", "extent": {"body": "bar", "axis": "y"}}],
    },
    name="bar",
)
# %% [markdown]
# ## What was measured
#
# One bar is slow and one is fast: the slow one says more of the yield stress A, the fast one of the hardening B. Here they are runs with A = 175 MPa and B = 380 MPa.
# %%
experiments = []
for speed in (-120.0, -250.0):
    bar = deck.copy()
    bar[A], bar[B], bar["body.bar.velocity.1"] = "175 MPa", "380 MPa", speed
    run = sp.Simulation(bar, out=f"measured/{-speed:.0f}", overwrite=True, progress=False).run()
    height = run.measures["height"]
    print(f"{-speed:.0f} m/s: {1e3 * height:.3f} mm")
    experiments.append(sp.Experiment({"height": (height, "0.05 mm")}, set={"body.bar.velocity.1": speed}, name=f"{-speed:.0f} m per s"))
# %% [markdown]
# ## What is found
#
# Bounds are all the search knows. Each point is two runs; they are processes, and what is there is not run again.
# %%
fit = sp.calibrate(deck, {A: ("80 MPa", "350 MPa"), B: ("100 MPa", "700 MPa")}, experiments, out="fit", workers=2)
fit
# %%
for key, true in ((A, 175e6), (B, 380e6)):
    print(f"{key.split('.')[-1]}: {fit.values[key] / 1e6:7.2f} MPa, {100 * (fit.values[key] / true - 1):+.2f} % from what the bars were made of")
# %% [markdown]
# `fit.errors` says how far a constant may move before a height is off by its uncertainty: two bars of one shape hardly tell A from B.
# %%
{key.split(".")[-1]: f"± {error / 1e6:.0f} MPa" for key, error in fit.errors.items()}
# %%
fit.studies["250 m per s"].runs[-1].plot("plastic_strain", width="110 mm", dpi=80)
