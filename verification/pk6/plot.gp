# Diffusion constant in the small domain; below, the local order of the runs at rest and the density between walls.
names = "'rest' 'rest, coarse' 'walls' 'walls, coarse' 'flow' 'flow, walls'"
array colour[6] = [blue, blue, red, red, green, purple]
array symbol[6] = [7, 7, 5, 5, 8, 12]
array label[6] = ["periodic, at rest", "", "walls, at rest", "", "periodic, in flow", "walls, in flow"]
all(n, quantity) = "all:".word(names, n).":".quantity

@upper
set bmargin at screen 0.555
set logscale y
set xrange [0:21]; set yrange [1e-6:1]
set format x "%g"; set format y "10^{%T}"
set xtics 5
set xlabel "atoms per particle N_m" offset 0,0.6
set ylabel "diffusion constant D (DPD units)" offset 0.5,0
set key bottom left maxrows 4
plot for [n=1:6] data index all(n, "diffusion_constant") using 1:2:3 with yerrorlines pt symbol[n] lw 1.5 lc rgb colour[n] title label[n]
@lower
set tmargin at screen 0.455
set rmargin at screen 0.52
set xlabel "atoms per particle N_m" offset 0,0.4
set ylabel "local order q_6" offset 0.5,0
set yrange [0:0.55]
set ytics 0.1
set key top left maxrows 2
plot for [n=1:4] data index all(n, "local_q6") using 1:2:3 with yerrorlines pt symbol[n] lw 1.5 lc rgb colour[n] title label[n]
unset label 1
set lmargin at screen 0.63; set rmargin at screen 0.965
set xlabel "distance from the wall (r_c)"
set ylabel "density n (r_c^{-3})" offset 0.5,0
set xrange [-0.2:3.5]; set yrange [0:*]
set xtics 1; set ytics auto
unset key
plot [-0.2:3.5] 3 with lines lw 2 lc rgb grey, \
     data index "all:n(y), 5:density_profile" using ($1 - 1):2:3 with yerrorlines pt 12 ps 0.7 lw 1.5 lc rgb purple
@finish
set lmargin at screen 0.14
set xtics auto; set format
set key
