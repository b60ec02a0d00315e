# Diffusion constant against friction: integrators, boxes, molecular chaos. The infinite system is the largest box with
# Yeh & Hummer's correction, eta + n m D for eta as in a gas; the first pass keeps the viscosity from shear.
frictions = "3.375 6.75 13.5 27"
array eta[words(frictions)]
index_of(x) = sum [i=1:words(frictions)] (abs(x/word(frictions, i) - 1) < 1e-6 ? i : 0)
part(curve) = "all:".curve.":diffusion_constant"
own = part("exponential"); chaos = "all:chaos:green_kubo_diffusion_constant"
set table $kept
plot data index "all:shear:viscosity" using 1:(eta[index_of($1)] = $2)
array reference[words(frictions)]
plot data index own using 1:(reference[index_of($1)] = $2)
unset table
correction(x, D, L) = 2.837297/(6*pi*(eta[index_of(x)] + 3*D)*L)
deviation(x, D) = 100*(D/reference[index_of(x)] - 1)
relative(x, e) = 100*e/reference[index_of(x)]

@upper
set logscale xy
set xrange [2.9:31]; set yrange [0.07:5]; set ytics (0.1, 0.2, 0.3, 0.5, 1, 2)
set xtics (3.375, 6.75, 13.5, 27)
set ylabel "diffusion constant D*" offset 0.5,0
set key top right
plot lines index "exponential:diffusion_constant:ng17-limit" using 1:2 with lines lw 2 dt 2 lc rgb grey title "Groot \\& Warren's estimate", \
     lines index "exponential:diffusion_constant:ng17" using 1:2 with lines lw 2 lc rgb blue title "molecular chaos, Δt* = 0.04", \
     data index chaos using 1:2:3 with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb blue title "positions redrawn", \
     data index own using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb red title "exponential, 1000 particles", \
     data index part("L=14.42") using 1:($2 + correction($1, $2, 14.4225)):3 with yerrorbars pt 4 ps 1.4 lw 1.5 lc rgb black title "infinite system", \
     data index part("linear") using 1:2:3 with yerrorbars pt 9 lw 1.5 lc rgb green title "linear weight"
@lower
set xlabel "friction γ*" offset 0,0.4
set yrange [-4:18]; set ytics auto
set ylabel "deviation (%)" offset 0.5,0
set key top left
plot 0 with lines lw 2 lc rgb red notitle, \
     data index part("S1") using ($1*0.97):(deviation($1, $2)):(relative($1, $3)) with yerrorbars pt 5 lw 1.5 lc rgb purple title "S1", \
     data index part("velocity-Verlet") using 1:(deviation($1, $2)):(relative($1, $3)) with yerrorbars pt 11 lw 1.5 lc rgb sky title "modified velocity-Verlet", \
     data index part("L=10") using ($1*1.03):(deviation($1, $2)):(relative($1, $3)) with yerrorbars pt 6 lw 1.5 lc rgb yellow title "box 10^3", \
     data index part("L=14.42") using ($1*1.06):(deviation($1, $2 + correction($1, $2, 14.4225))):(relative($1, $3)) with yerrorbars pt 4 lw 1.5 lc rgb black title "infinite system"
@finish
