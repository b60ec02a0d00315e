# The Lennard-Jones fluid against temperature: viscosity, and inverse compressibility with two cutoffs and with none.
@upper
set xrange [0.65:2.15]; set yrange [1.6:2.7]
set ylabel "viscosity (m/(στ))" offset 0.5,0
set key top right maxrows 3
plot [0.65:2.15] 1.97 with lines dt 2 lw 2 lc rgb black title "printed: 1.97", \
     data index "all:shear:viscosity" using 1:2:3 with yerrorlines pt 7 lw 1.5 lc rgb blue title "cutoff 2.5, shear rate 0.1", \
     data index "all:other rate:viscosity" using 1:2:3 with yerrorbars pt 6 ps 1.6 lw 1.5 lc rgb red title "shear rate 0.05"
@lower
set xlabel "temperature (ε/k_B)" offset 0,0.4
set ylabel "κ^{-1}" offset 0.5,0
set yrange [13:20]
set key top right maxrows 2
plot [0.65:2.15] 15.36 with lines dt 2 lw 2 lc rgb black title "printed: 15.36", \
     lines index "far:inverse_compressibility" using 1:2 with lines lw 2 lc rgb grey title "equation of state", \
     data index "all:shear:inverse_compressibility" using 1:2:3 with yerrorlines pt 7 lw 1.5 lc rgb blue title "cutoff 2.5", \
     data index "all:far:inverse_compressibility" using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb green title "cutoff 4"
@finish
