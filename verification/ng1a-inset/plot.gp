# Diffusion constant against the step, friction 9.
msd = "gamma=9:diffusion_constant:ng17"
q = ":green_kubo_diffusion_constant:ng17"

@upper
set logscale xy
set xrange [0.008:1.3]; set yrange [0.09:0.9]; set ytics (0.1, 0.2, 0.3, 0.5, 0.8)
set ylabel "diffusion constant D*" offset 0.5,0
set key top left
plot lines index msd using 1:2 with lines lw 2 lc rgb blue title "eq. 17", \
     lines index "gamma=9:diffusion_constant:memory-D" using 1:2 with lines lw 1.5 dt 2 lc rgb blue title "with memory", \
     data index msd using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title "dynamics", \
     data index "chaos".q using 1:2:3 with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb red title "positions redrawn", \
     data index "chaos, long step".q using 1:2:3 with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb red notitle
@lower
set xlabel "time step Δt*" offset 0,0.4
set yrange [-10:100]; set ytics auto
unset key
plot 0 with lines lw 2 lc rgb grey, \
     data index msd using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue, \
     data index "chaos".q using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb red, \
     data index "chaos, long step".q using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb red
@finish
