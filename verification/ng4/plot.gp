# Diffusion constant against the strength of the potential: rescaling and DPD; below, their ratio.
fast = "rescaling:diffusion_constant:curve:DPD"

@upper
set logscale y
set xrange [0:105]; set yrange [0.07:3]
set ylabel "diffusion constant D*" offset 0.5,0
set key top right
plot data index "all:rescaling:diffusion_constant" using 1:2:3 with yerrorlines pt 7 lw 1.5 lc rgb blue title "velocity rescaling", \
     data index "all:layers:diffusion_constant" using ($1+1.5):2:3 with yerrorbars pt 4 ps 1.3 lw 1.5 lc rgb green title "in layers", \
     data index "all:Monte Carlo:diffusion_constant" using ($1+3):2:3 with yerrorbars pt 8 ps 1.3 lw 1.5 lc rgb purple title "Monte Carlo", \
     data index "all:DPD:diffusion_constant" using 1:2:3 with yerrorlines pt 5 lw 1.5 lc rgb red title "DPD, γ* = 4.5"
@lower
set xlabel "potential strength a" offset 0,0.4
set ylabel "gain over DPD (%)" offset 0.5,0
set logscale y; set yrange [10:600]
unset key
plot data index fast using 1:(100*$5):(100*$6) with yerrorlines pt 7 lw 1.5 lc rgb blue
@finish
