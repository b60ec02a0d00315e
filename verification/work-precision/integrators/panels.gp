# Seven panels, one per observable, and the key in the eighth place. Before it is loaded: draw(o), a string with what is
# plotted of observable o; shown, a list of the integrators in it.
unset logscale
set logscale xy
set format y "%g"
set lmargin; set rmargin; unset grid
set tics font ",".caption_size
set format x x_format
array colours[10] = [yellow, red, purple, black, green, blue, "#882255", sky, "#999933", "#8B4513"]  # as in the maps of stability
set multiplot layout 4,2 title title_text."\n{/*0.75 ".caption."}" offset 0,0.3 margins 0.08,0.98,0.06,0.915 spacing 0.085,0.062
do for [o = 1:|observables|] {
    set title labels[o] offset 0,-0.6
    unset key
    if (o > 5) { set xlabel x_label offset 0,0.5 } else { unset xlabel }
    if (o % 2 == 1) { set ylabel y_label offset 1.5,0 } else { unset ylabel }
    eval "plot ".draw(o)
}
unset title; unset border; unset tics; unset xlabel; unset ylabel
set key center center vertical maxrows 10 samplen 2 spacing 1.25 nobox
set xrange [0:1]; set yrange [1:2]
unset logscale
plot for [n in shown] NaN with linespoints lw 1.6 pt (4 + n) ps 0.7 lc rgb colours[n+0] title names[n+0]
unset multiplot
