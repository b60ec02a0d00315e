# Diffusion constant against the number of atoms per particle; below, mean-square displacements for 1 and 100.
msd = ":mean_square_displacement"

@upper
set bmargin at screen 0.555
set logscale xy
set xrange [0.9:120]; set yrange [5e-8:0.1]
set format x "%g"; set format y "10^{%T}"
set xtics (1, 2, 5, 10, 20, 30, 50, 100)
set xlabel "atoms per particle N_m" offset 0,0.6
set ylabel "diffusion constant D (DPD units)" offset 0.5,0
set key bottom left maxrows 2
plot data index "all:D:diffusion_constant" using (1):($1 == 1 ? $2/450 : NaN):(29):(0) with vectors nohead dt 2 lw 2 lc rgb grey notitle, \
     data index "all:D:diffusion_constant" using (30):($1 == 1 ? $2/450 : NaN) with points pt 3 ps 1.6 lw 2 lc rgb red title "D(1)/450, printed for 30", \
     data index "all:D:diffusion_constant" using 1:2:3 with yerrorlines pt 7 lw 1.5 lc rgb blue title "measured"
@lower
set tmargin at screen 0.465
set logscale xy
set xrange [0.015:300]; set yrange [5e-5:60]
set format y "10^{%T}"; set format x "10^{%T}"
set xtics auto
set xlabel "time t (DPD units)" offset 0,0.4
set ylabel "⟨Δr^2⟩ (DPD units)" offset 0.5,0
set key top left maxrows 2
set label 2 "∝ t^2" at 0.03,4e-3 tc rgb grey
set label 3 "∝ t" at 24,14 tc rgb grey
plot [0.015:300] x < 0.4 ? 0.6*x**2 : NaN with lines lw 2 lc rgb grey notitle, \
     x > 5 ? 0.2*x : NaN with lines lw 2 lc rgb grey notitle, \
     data index "all:MSD 1, short".msd using 1:2 with lines lw 3 lc rgb blue notitle, \
     data index "all:MSD 1".msd using 1:2 with lines lw 3 lc rgb blue title "N_m = 1", \
     data index "all:MSD 100, short".msd using 1:2 with lines lw 3 lc rgb red notitle, \
     data index "all:MSD 100".msd using 1:2 with lines lw 3 lc rgb red title "N_m = 100"
@finish
unset label 2; unset label 3
unset logscale
set format
