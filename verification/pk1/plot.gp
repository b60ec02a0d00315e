# Viscosity against the number of atoms per particle, with the paper's second-order polynomial, fitted up to ten; below, what is
# left of the fit, the other rates and the Poiseuille flows.
v = ":viscosity"; flow = ":poiseuille_viscosity"
verlet = "all:Verlet".v
rates = "0.5 25 50"
array colour[3] = [green, red, purple]
array symbol[3] = [5, 9, 13]

set autoscale
set fit quiet logfile '/dev/null'
p(x) = c0 + c1*x + c2*x**2
c0 = 0.9; c1 = 0.1; c2 = 0.02; top = 10.5
stats data index verlet using ($1 < top ? $1 : NaN) name "inside" nooutput
if (exists("inside_records")) { if (inside_records > 3) { fit [0.5:top] p(x) data index verlet using 1:2:3 yerror via c0, c1, c2 }}

@upper
set logscale xy
set xrange [0.9:22]; set yrange [0.1:1500]
set xtics (1, 2, 3, 5, 7, 10, 13, 17, 20)
set ylabel "viscosity μ (DPD units)" offset 0.5,0
set key top left maxrows 3 width -3
set label 2 sprintf("dashed: %.3f + %.3f N_m + %.4f N_m^2\nfitted up to N_m = 10", c0, c1, c2) at 2.9,0.4
plot [0.9:22] x < top ? p(x) : NaN with lines dt 2 lw 2 lc rgb black notitle, \
     x < top ? NaN : p(x) with lines dt 3 lw 1.5 lc rgb grey notitle, \
     data index verlet using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title "Verlet", \
     data index "all:Poiseuille".flow using 1:2:3 with yerrorbars pt 6 ps 1.7 lw 1.5 lc rgb blue title "Verlet, Poiseuille", \
     for [n=1:3] data index "all:Lowe ".word(rates, n).v using 1:2:3 with yerrorbars pt symbol[n] lw 1.5 lc rgb colour[n] title "Lowe-Andersen, Γ = ".word(rates, n), \
     data index "all:Poiseuille, Lowe 25".flow using 1:2:3 with yerrorbars pt 8 ps 1.7 lw 1.5 lc rgb red title "Γ = 25, Poiseuille"
@lower
unset label 2
set xlabel "atoms per particle N_m" offset 0,0.4
set yrange [-20:25]; set ytics 10
set key bottom left maxrows 2
# points beyond the range are named instead
beyond = ""
stats data index verlet using ($1 > top ? (beyond = beyond.sprintf(", %+.0f %% at %g", 100*($2/p($1) - 1), $1), $1) : NaN) nooutput
set label 2 strlen(beyond) ? "beyond the fit: ".beyond[3:] : "" at graph 0.02,0.92
plot [0.9:22] 0 with lines lw 2 lc rgb grey notitle, \
     data index verlet using 1:(100*($2/p($1) - 1)):(100*$3/p($1)) with yerrorbars pt 7 lw 1.5 lc rgb blue title "Verlet from the fit", \
     data index "other rate:viscosity:curve:Verlet" using ($1*1.02):(100*$5):(100*$6) with yerrorbars pt 2 lw 1.5 lc rgb yellow title "other rate from Verlet", \
     data index "Poiseuille:poiseuille_viscosity:" using ($1*0.98):(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb black title "Poiseuille from shear", \
     data index "Poiseuille, Lowe 25:poiseuille_viscosity:" using ($1*0.98):(100*$5):(100*$6) with yerrorbars pt 8 ps 1.4 lw 1.5 lc rgb red title "the same, Γ = 25"
@finish
unset label 2
set xtics auto; set ytics auto
