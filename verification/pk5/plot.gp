# Velocity across the channel in the atoms' units for different numbers of atoms per particle, against the incompressible
# solution, and a power law fitted at nine; below, the temperature. Opposed flows are laid over each other.
atoms = "2 3 5 6 9 13"
array shade[6] = ["#440154", "#414487", "#2a788e", "#22a884", "#c8a800", "#e06000"]
array symbol[6] = [6, 4, 8, 12, 7, 5]
width = 34.2
cutoff(N) = (3.75*N)**(1./3)
# height in its channel, of a bin of the doubled box
height(y, N) = floor(1000*(y*cutoff(N) - width*floor(y*cutoff(N)/width)) + 0.5)/1000.
parabola(z) = 0.5*(0.8*0.0085/1.97)*z*(width - z)

set autoscale
set fit quiet logfile '/dev/null'
at_nine = "all:u(z), 9:channel_profile"
power_law(z) = largest*(1 - abs(1 - 2*z/width)**(1/index + 1))
largest = 0.7; index = 0.8; fitted = 0
stats data index at_nine using 1 name "nine" nooutput
if (exists("nine_records")) { if (nine_records > 3) { fitted = 1; fit power_law(x) data index at_nine using 1:2 via largest, index }}

# the coarsest is drawn as far as it fits, its largest values are named
largest_of(quantity) = exists(quantity."_max") ? sprintf("up to %.2f", value(quantity."_max")) : "none"
stats data index "all:u(z), 13:channel_profile" using 2 name "u13" nooutput
stats data index "all:T(z), 13:temperature_profile" using 2 name "T13" nooutput

@upper
set xrange [0:width]; set yrange [0:1.4]
set ylabel "velocity u (σ/τ)" offset 0.5,0
set key bottom center maxrows 4 samplen 1 width -4 spacing 1 font ",".caption_size
plot for [n=1:6] data index "all:u(z), ".word(atoms, n).":channel_profile" using 1:2 with points pt symbol[n] ps 0.8 lw 1.2 lc rgb shade[n] title (n == 1 ? "N_m = " : "").word(atoms, n).(n == 6 ? ", ".largest_of("u13") : ""), \
     parabola(x) with lines lw 2 lc rgb black title "Navier and Stokes", \
     fitted ? power_law(x) : NaN with lines dt 2 lw 2 lc rgb black title fitted ? sprintf("power law, %.3f", index) : ""
@lower
set xlabel "height z (σ)" offset 0,0.4
set ylabel "temperature kT" offset 0.5,0
set yrange [0.098:0.124]
unset key
set label 2 "N_m = 13: ".largest_of("T13") at graph 0.02,0.9 tc rgb shade[6]
plot [0:width] 0.1 with lines lw 2 lc rgb grey, \
     for [n=1:6] data index "all:T(z), ".word(atoms, n).":temperature_profile" using (height($1, word(atoms, n))):2 smooth unique with linespoints pt symbol[n] ps 0.6 lw 1.2 lc rgb shade[n]
@finish
unset label 2
set key
