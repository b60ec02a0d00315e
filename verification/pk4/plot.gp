# Speed of sound and velocity of the Poiseuille flow; below, the Mach number that follows from them, at the paper's force and at
# a tenth of it.
parts = "'g(r)' 'g(r), coarse'"
all(part, quantity) = "all:".word(parts, part).":".quantity

@upper
set logscale xy
set xrange [0.9:22]; set yrange [0.05:20]
set xtics (1, 2, 3, 5, 7, 10, 13, 20)
set ylabel "speed (DPD units)" offset 0.5,0
set key bottom right maxrows 4
# as vectors from point to point, which also join the two parts of the line
x0 = NaN; y0 = NaN
plot lines using (x = x0, x0 = $1, x):(y = y0, y0 = $2, y):(x0 - x):(y0 - y) with vectors nohead lw 2 lc rgb grey notitle, \
     NaN with lines lw 2 lc rgb grey title "c, eq. 3", \
     for [n=1:2] data index all(n, "speed_of_sound") using 1:2:3 with yerrorbars pt 4 ps 1.8 lw 1.5 lc rgb red title n == 1 ? "c, slope of p" : "", \
     for [n=1:2] data index all(n, "speed_of_sound_by_g") using 1:2:3 with yerrorbars pt 7 ps 0.9 lw 1.5 lc rgb blue title n == 1 ? "c, eq. 7" : "", \
     data index "all:viscosity:predicted_velocity" using 1:2:3 with yerrorlines pt 9 lw 1.5 lc rgb green title "u_{max}, predicted"
@lower
set logscale y
set xlabel "atoms per particle N_m" offset 0,0.4
set ylabel "Mach number" offset 0.5,0
set yrange [0.006:3]
set key top left maxrows 2
set label 2 "0.15" at 1.1,0.20 tc rgb grey
plot [0.9:22] 0.15 with lines lw 2 lc rgb grey notitle, \
     data index "all:viscosity:predicted_mach_number" using 1:2:3 with yerrorlines pt 9 lw 1.5 lc rgb green title "force 0.0085", \
     data index "all:viscosity:predicted_mach_number" using 1:(0.1*$2):(0.1*$3) with yerrorlines pt 8 lw 1.5 lc rgb purple title "force 0.00085"
@finish
unset label 2
set xtics auto
