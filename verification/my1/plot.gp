# 1/T against the step: full lines are eq. 22, dashed ones theory with memory, dotted ones the
# bound of both limits; filled points the dynamics, open ones
# positions redrawn every step.
names = "0.05 0.1 0.2 0.5"
array colour[4] = [green, blue, red, purple]
q = "kinetic_temperature:my22"; bound = "kinetic_temperature:my22-mean-mode"; memory = "kinetic_temperature:memory-kT"
part(n, kind, q) = "n=".word(names, n).kind.":".q

@upper
set xrange [0:1.02]; set yrange [0:2.05]
set ylabel "inverse temperature 1/{/:Italic kT}" offset 0.5,0
set key top right samplen 1 width -2 spacing 1 font ",".caption_size
plot for [n=1:4] lines index part(n, "", q) using 1:(1/$2) with lines lw 2 lc rgb colour[n] notitle, \
     for [n=1:4] lines index part(n, "", memory) using 1:(1/$2) with lines lw 1.5 dt 2 lc rgb colour[n] notitle, \
     for [n=1:4] lines index part(n, "", bound) using 1:(1/$2) with lines lw 1.5 dt 3 lc rgb colour[n] notitle, \
     for [n=1:4] data index part(n, "", q) using 1:(1/$2):($3/$2**2) with yerrorbars pt 7 ps 1 lw 1.5 lc rgb colour[n] title "n = ".word(names, n), \
     for [n=2:4] data index part(n, " edge", q) using 1:(1/$2) with points pt 7 ps 1 lw 1.5 lc rgb colour[n] notitle, \
     data index part(4, " onset", q) using 1:(1/$2):($3/$2**2) with yerrorbars pt 7 ps 1 lw 1.5 lc rgb colour[4] notitle, \
     for [n=1:4] data index part(n, " chaos", q) using 1:(1/$2):($3/$2**2) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb colour[n] notitle, \
     data index "n=0.2 old momentum:".q using 1:(1/$2) with points pt 2 ps 1 lw 1.5 lc rgb black title "n = 0.2, old momentum", \
     data index "n=0.2 old momentum edge:".q using 1:(1/$2) with points pt 2 ps 1 lw 1.5 lc rgb black notitle, \
     NaN with points pt 6 ps 1.4 lc rgb black title "positions redrawn", \
     NaN with lines lw 1.5 dt 2 lc rgb black title "with memory"
@lower
set key font ","
set xlabel "time step Δt" offset 0,0.4
set yrange [-25:10]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     for [n=1:4] data index part(n, "", q) using 1:(100*$5):(100*$6) with yerrorbars pt 7 ps 1 lw 1.5 lc rgb colour[n], \
     for [n=1:4] data index part(n, " chaos", q) using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb colour[n], \
     data index "n=0.2 old momentum:".q using 1:(100*$5):(100*$6) with yerrorbars pt 2 ps 1 lw 1.5 lc rgb black
@finish
