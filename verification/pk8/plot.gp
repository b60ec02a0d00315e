# Schmidt number against the number of atoms per particle; below, the viscosity and the diffusion constant that make it up,
# relative to one atom per particle.
sc = "all:Sc:schmidt_number"

@upper
set logscale xy
set xrange [0.85:55]; set yrange [3:1e8]
set xtics (1, 2, 3, 5, 7, 10, 15, 20, 30)
set format y "10^{%T}"
set ylabel "Schmidt number μ/(nMD)" offset 0.5,0
set key top left maxrows 2
plot data index sc using (1):($1 == 1 ? 1e5*$2 : NaN):(29):(0) with vectors nohead dt 2 lw 2 lc rgb grey notitle, \
     NaN with lines dt 2 lw 2 lc rgb grey title "five orders of magnitude above one atom", \
     data index sc using 1:2:3 with yerrorlines pt 7 lw 1.5 lc rgb blue title "measured", \
     data index sc using 1:($1 == 1 ? $2 : NaN):(sprintf("%.1f", $2)) with labels offset 0,0.9 tc rgb blue notitle, \
     data index sc using 1:($1 == 30 ? $2 : NaN):(gprintf("%.1t·10^{%T}", $2)) with labels left offset 0.9,0 tc rgb blue notitle
@lower
set logscale y
set format y "10^{%T}"
set xlabel "atoms per particle N_m" offset 0,0.4
set ylabel "relative to N_m = 1" offset 0.5,0
set yrange [3e-4:2000]
set key top left maxrows 2
at_one = NaN
plot [0.85:55] 1 with lines lw 2 lc rgb grey notitle, \
     data index "all:Sc:viscosity" using 1:(at_one = $1 == 1 ? $2 : at_one, $2/at_one):($3/at_one) with yerrorlines pt 5 lw 1.5 lc rgb red title "viscosity", \
     data index "all:D:diffusion_constant" using 1:(at_one = $1 == 1 ? $2 : at_one, $2/at_one):($3/at_one) with yerrorlines pt 9 lw 1.5 lc rgb green title "diffusion constant"
@finish
set xtics auto
set format
