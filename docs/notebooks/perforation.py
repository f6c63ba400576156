# %% [markdown]
# # How fast is what comes out of a plate?
#
# A steel slug strikes a plate of aluminium in plane strain. A sweep over its speed gives the residual velocity, and the curve of Recht and Ipson through it the
# speed below which the plate holds. The aluminium opens where its tension reaches a spall pressure; it has no other fracture here, and six particles through its thickness:
# this shows how such a study is made, and predicts no plate.
# %%
import sphorge as sp

deck = sp.Deck(
    {
        "title": "Slug through a plate, coarse",
        "dimensions": "plane-strain",
        "particles": {"spacing": "1 mm"},
        "time": {"end": "100 us"},
        "output": {"frames": 10},
        "material": {"aluminium": {"base": "6061-t6-aluminium", "spall-pressure": "1.2 GPa"}},
        "body": [
            {
                "name": "plate",
                "material": "aluminium",
                "shape": {"box": {"min": ["-60 mm", "-6 mm"], "max": ["60 mm", "0 mm"]}},
                "velocity": ["0 m/s", "0 m/s"],
            },
            {
                "name": "slug",
                "material": "4340-steel",
                "shape": {"box": {"min": ["-6 mm", "1 mm"], "max": ["6 mm", "19 mm"]}},
                "velocity": ["0 m/s", "-400 m/s"],
            },
        ],
        "measure": [{"name": "residual", "mean": {"body": "slug", "field": "velocity", "component": "y"}}],
    },
    name="slug",
)
sp.materials["6061-t6-aluminium"]["reference"]
# %% [markdown]
# ## One shot
# %%
simulation = sp.Simulation(deck, out="one", overwrite=True)
run = simulation.run()
run
# %%
run.plot("speed", frames=["first", "last"], width="160 mm", dpi=80)
# %% [markdown]
# ## All of them
#
# Each run is a process; the same call again makes only what is missing.
# %%
speeds = [-300.0, -400.0, -500.0, -600.0]
study = sp.sweep(deck, {"body.slug.velocity.1": speeds}, out="shots", workers=2)
study
# %% [markdown]
# ## Recht and Ipson
#
# $v_r = a\,\sqrt{v^2 - v_{bl}^2}$ (R. F. Recht, T. W. Ipson, Journal of Applied Mechanics 30 (1963) 384): a straight line of $v_r^2$ over $v^2$.
# %%
import numpy as np

v, out = -np.array(study.table["body.slug.velocity.1"]), -np.array(study.table["residual"])
slope, offset = np.polyfit(v**2, out**2, 1)
print(f"a = {np.sqrt(slope):.3f}, ballistic limit {np.sqrt(max(-offset / slope, 0.0)):.0f} m/s")
for speed, residual in zip(v, out):
    print(f"{speed:4.0f} m/s: {residual:4.0f} m/s, curve {np.sqrt(max(slope * speed**2 + offset, 0.0)):4.0f} m/s")
