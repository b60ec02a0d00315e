# Integrators, their colours and symbols; what the maps' columns are. Loaded by the plots of this folder.
array name[10] = ["Euler, old", "Euler, new", "GW 0.5", "GW 0.65", "DPD-VV", "S1", "Peters", "Lowe", "S1-MTS", "ABOBA"]
array colour[10] = [yellow, red, purple, black, green, blue, sky, "#999933", "#882255", "#8B4513"]
array symbol[10] = [2, 7, 5, 13, 9, 11, 1, 3, 15, 6]
# usable, bounded: columns of the step; the next one is its flag
usable = 4; bounded = 6; critical = 10; harmonic = 11; rates = 12; hessian = 13
edge(c) = column(c + 1) == 0 ? column(c) : NaN
none(c) = column(c + 1) == 1 ? column(c) : NaN
file(map) = data."/".map.".dat"
both(r, c) = 1.0/(r/2 + sqrt(r**2/4 + 1/c**2))  # the smaller root of (t c)^2 + t r = 1, see docs/stability.md
