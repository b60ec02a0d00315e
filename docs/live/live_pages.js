// What each live page has: its scenes, sliders, views, numbers, and what it says. live.js does the rest.
{
    const text = Live.text, side = (particles, density, dimension) => (particles / density) ** (1 / dimension)
    const sets = overrides => overrides.map(each => ` --set '${each}'`).join("")
    const run = (file, overrides) => `dpdref run verification/scenes/live/${file}.toml${sets(overrides)}`
    const range = (from, to, count) => Array.from({ length: count }, (_, k) => from + (to - from) * k / (count - 1))
    const kT = scene => (scene.quantities().kinetic_temperature || null)
    const square = (n, density) => { const l = Number(side(n, density, 2).toPrecision(7)); return `box.length=[${l}, ${l}]` }

    Live.pages.fluid = {
        files: { fluid: "fluid" },
        endless: true,
        controls: [
            { name: "friction", label: "friction", from: 0.1, to: 50, value: 4.5, log: true },
            { name: "step", label: "time step", from: 0.005, to: 0.3, value: 0.02, log: true },
            { name: "density", label: "density", from: 1, to: 6, value: 3 },
            { name: "repulsion", label: "repulsion", from: 0, to: 75, value: 25 },
        ],
        set: v => [square(1600, v.density), `shardlow.friction=${v.friction}`, `time.step=${v.step}`, `verlet.soft.strength=${v.repulsion}`],
        views: [{
            label: "1600 particles of the fluid, coloured by speed.",
            caption: "1600 soft particles in two dimensions, computed by the engine of this book while you look. Blue is slow, orange fast.",
            draw: (canvas, page) => Live.particles(canvas, page.scenes.fluid),
        }],
        numbers(page) {
            const q = page.scenes.fluid.quantities()
            return [["", "measured", "set"], ["temperature kT", Live.withError(q.kinetic_temperature), "1"],
                ["potential energy of a particle, kT", Live.withError(q.potential_energy), ""]]
        },
        summary: page => `The temperature is ${Live.withError(kT(page.scenes.fluid))}; friction and noise ask for 1.`,
        doors: [["Learn", "introduction.html"], ["Turn up the step", "live-step.html"], ["See a figure", "gallery.html"], ["Check my code", "answers.html"]],
        command: v => run("fluid", Live.pages.fluid.set(v)),
    }

    // MY1997
    const fluid1997 = (v, extra = []) => ["d=2", `n=${v.density}`, "gamma=1", "rc=4", "weight=parabolic", ...extra]
    Live.pages.step = {
        files: { euler: "step", s1: "step_s1" },
        endless: true,
        points: [],
        controls: [
            { name: "step", label: "time step Δt", from: 0.02, to: 0.7, value: 0.1 },
            { name: "density", label: "density", from: 0.05, to: 0.8, value: 0.2, log: true },
            { name: "strangers", label: "redraw all positions after every step: partners are strangers", value: false },
        ],
        set: (v, key) => [square(1600, v.density), `time.step=${v.step}`,
            ...(key === "euler" && v.strangers ? ["stages=['euler', 'kick', 'sample', 'drift', 'scatter']"] : [])],
        leaving() { this.keep() },
        begun() {
            this.now = { step: this.values.step, density: this.values.density, strangers: this.values.strangers }
        },
        // the point at which the sliders stood
        keep() {
            const q = kT(this.scenes.euler)
            if (q && q[2] > 3 && this.scenes.euler.status !== 3 && q[1] < 0.5 * q[0]) this.points.push({ ...this.now, kT: q[0], error: q[1] })
        },
        critical: page => page.engine.theory("my25", fluid1997(page.values)),
        buttons: [{ text: "Forget the points", action: page => { page.points = [] } }],
        boiled: () => "The Euler fluid has boiled: beyond the critical step it has no temperature. Move the step back.",
        views: [{
            label: "Particles of the Euler fluid, coloured by speed.",
            caption: "All pairs at once (explicit Euler): the colours are speeds over the thermal one at kT = 0.5.",
            draw: (canvas, page) => Live.particles(canvas, page.scenes.euler, { kT: 0.5, size: 0.5 }),
        }, {
            label: "Temperature against the time step.",
            caption: "Line: eq. 22, from the set temperature at Δt = 0 to infinity at the critical step of eq. 25 (dotted). Filled points: this fluid; open points: the same with redrawn positions.",
            draw(canvas, page) {
                const critical = page.critical(page), steps = range(0.002, Math.min(0.72, 0.995 * critical), 80)
                const q = kT(page.scenes.euler), s = kT(page.scenes.s1)
                const points = page.points.filter(p => p.density === page.values.density)
                if (q && page.scenes.euler.status !== 3) points.push({ ...page.now, kT: q[0], error: Live.number(q[1]) })
                const of = strangers => points.filter(p => p.strangers === strangers)
                const series = (strangers, name, kind) => ({ name, kind, colour: Live.colours().series[1],
                    x: of(strangers).map(p => p.step), y: of(strangers).map(p => p.kT), error: of(strangers).map(p => p.error) })
                Live.plot(canvas, { x: [0, 0.72], y: [0, 3], labels: ["time step Δt", "temperature kT"],
                    marks: critical < 0.72 ? [{ x: critical, text: "critical step" }] : [],
                    series: [{ name: "eq. 22", kind: "line", x: steps, y: steps.map(dt => page.engine.theory("my22", fluid1997(page.values, ["sigma=1", `dt=${dt}`]))) },
                        series(false, "all at once (Euler)", "points"), series(true, "… positions redrawn", "open"),
                        { name: "pair after pair (S1)", kind: "points", colour: Live.colours().series[2], x: s ? [page.values.step] : [], y: s ? [s[0]] : [], error: s ? [Live.number(s[1])] : [] }] })
            },
            says: page => `Euler ${Live.withError(kT(page.scenes.euler))}, S1 ${Live.withError(kT(page.scenes.s1))} at step ${text(page.values.step)}.`,
        }],
        numbers(page) {
            const eq22 = page.engine.theory("my22", fluid1997(page.values, ["sigma=1", `dt=${page.values.step}`]))
            return [["", "kT measured", "kT expected"],
                [page.values.strangers ? "Euler, positions redrawn" : "all at once (Euler)", page.scenes.euler.status === 3 ? "boiled" : Live.withError(kT(page.scenes.euler)), "eq. 22: " + (Number.isFinite(eq22) ? text(eq22) : "none")],
                ["pair after pair (S1)", Live.withError(kT(page.scenes.s1)), "exact: 0.5"],
                ["critical step, eq. 25", "", text(page.critical(page))]]
        },
        summary: page => `At step ${text(page.values.step)} the Euler fluid has kT ${page.scenes.euler.status === 3 ? "without bound" : Live.withError(kT(page.scenes.euler))}, S1 ${Live.withError(kT(page.scenes.s1))}.`,
        command: v => run("step", Live.pages.step.set(v, "euler")) + "\n" + run("step_s1", Live.pages.step.set(v, "s1")),
    }

    // NG2007
    const shear = {
        files: { shear: "shear" },
        controls: [
            { name: "friction", label: "friction γ", from: 0.5, to: 50, value: 9, log: true },
            { name: "step", label: "time step Δt", from: 0.02, to: 0.5, value: 0.1, log: true },
            { name: "rate", label: "shear rate", from: 0.02, to: 0.5, value: 0.2, log: true },
            { name: "repulsion", label: "repulsion a", from: 0, to: 30, value: 0 },
        ],
        set: v => [`shardlow.friction=${v.friction}`, `time.step=${v.step}`, `box.shear_rate=${v.rate}`, `verlet.soft.strength=${v.repulsion}`],
        parts: [["kinetic", "kinetic_viscosity", "ng8", "memory-kinetic"], ["collision", "collision_viscosity", "ng12", "memory-collision"],
            ["potential", "potential_viscosity", null, null]],
        given: v => ["n=3", `gamma=${v.friction}`, `dt=${v.step}`],
        begun() { this.errors = []; this.memory = {} },
        sampled() {
            const q = this.scenes.shear.quantities(), time = this.scenes.shear.state().measured_steps * this.values.step
            const entry = { time, of: this.parts.map(([, name]) => q[name] ? Live.number(q[name][1]) : NaN) }
            if (q.kinetic_viscosity && q.kinetic_viscosity[2] > 4) this.errors.push(entry)
            if (this.errors.length > 400) this.errors = this.errors.filter((_, k) => k % 2)
        },
        buttons: [{ text: "Theory with memory (half a minute)", action(page, write) {
            const known = page.parts.filter(([, , , id]) => id), memory = page.memory
            for (const [name] of known) memory[name] = "computing …"
            Live.slowTheory(known.map(([, , , id]) => [id, page.given(page.values)]), values => {
                known.forEach(([name], k) => { memory[name] = text(values[k]) })
                write()
            })
        } }],
        views: [{
            label: "Particles of the sheared fluid, seen along z, coloured by their speed relative to the flow.",
            caption: "1620 particles in three dimensions, seen along z. The upper half flows to the right; what leaves above comes back below, shifted and slower (Lees & Edwards).",
            draw: (canvas, page) => Live.particles(canvas, page.scenes.shear, { flow: page.values.rate, size: 0.22 }),
        }, {
            label: "Velocity profile across the flow.",
            caption: "Velocity along x against y, with the imposed line.",
            draw(canvas, page) {
                const c = page.scenes.shear.curve("velocity_profile"), height = page.scenes.shear.state().length[1], top = height / 2 * page.values.rate
                Live.plot(canvas, { x: [0, height], y: [-1.2 * top, 1.2 * top], labels: ["y", "velocity along x"],
                    series: [{ name: "imposed", kind: "line", x: [0, height], y: [-top, top] }, { name: "measured", kind: "points", ...c }] })
            },
        }, {
            label: "Errors of the viscosities against the measured time.",
            caption: "One standard error of each part against the time measured, both logarithmic. Dashed: the inverse root of time.",
            draw(canvas, page) {
                const t = page.errors.map(e => e.time), last = Math.max(1000, t[t.length - 1] || 0)
                const first = page.errors.length ? page.errors[Math.floor(page.errors.length / 2)] : null
                const line = first ? [10, last].map(x => first.of[1] * Math.sqrt(first.time / x)) : []
                Live.plot(canvas, { x: [10, last], y: [1e-4, 1], logX: true, logY: true, lowKey: true, labels: ["time measured", "standard error"],
                    series: [...page.parts.map(([name], k) => ({ name, kind: "line", x: t, y: page.errors.map(e => e.of[k]) })),
                        { name: "time to the −1/2", kind: "line", dashed: true, colour: Live.colours().faint, x: first ? [10, last] : [], y: line }] })
            },
        }],
        numbers(page) {
            const q = page.scenes.shear.quantities()
            return [["viscosity", "measured", "molecular chaos", "with memory"],
                ...page.parts.map(([name, series, id, memory]) => [name, Live.withError(q[series]),
                    id ? `${id === "ng8" ? "eq. 8" : "eq. 12"}: ${text(page.engine.theory(id, page.given(page.values)))}` : "no closed form",
                    memory ? (page.memory[name] || "press the button") : ""]),
                ["sum", Live.withError(q.viscosity), "", ""], ["temperature kT", Live.withError(q.kinetic_temperature), "exact: 1", ""]]
        },
        summary(page) {
            const q = page.scenes.shear.quantities()
            return `Kinetic viscosity ${Live.withError(q.kinetic_viscosity)}, collision viscosity ${Live.withError(q.collision_viscosity)}, potential viscosity ${Live.withError(q.potential_viscosity)}.`
        },
        command: v => run("shear", shear.set(v)),
    }
    Live.pages.shear = shear

    // PK2006
    Live.pages.freeze = {
        files: { fluid: "freeze" },
        endless: true,
        controls: [{ name: "atoms", label: "atoms per particle", from: 1, to: 30, value: 5, integer: true }],
        set: v => [`coarse_graining.atoms_per_particle=${v.atoms}`],
        views: [{
            label: "Particles of the fluid, seen along z.",
            caption: "1536 particles in three dimensions, seen along z, coloured by speed. A crystal shows as rows.",
            draw: (canvas, page) => Live.particles(canvas, page.scenes.fluid, { kT: 0.1, size: 0.17 }),
        }, {
            label: "Radial distribution function g(r).",
            caption: "g(r): how many neighbours a particle has at distance r, over those of an ideal gas.",
            draw(canvas, page) {
                const c = page.scenes.fluid.curve("radial_distribution")
                Live.plot(canvas, { x: [0, 2.5], y: [0, Math.max(3, ...c.y.map(Live.number).filter(Number.isFinite)) * 1.15], labels: ["r", "g(r)"],
                    series: [{ kind: "line", x: c.x, y: c.y }] })
            },
        }, {
            label: "Mean square displacement.",
            caption: "Mean square displacement against time: a fluid's rises for ever, its slope is 6D; a crystal's stays.",
            draw(canvas, page) {
                const c = page.scenes.fluid.curve("mean_square_displacement"), y = c.y.map(Live.number).filter(Number.isFinite)
                Live.plot(canvas, { x: [0, 10], y: [0, 1.1 * Math.max(0.05, ...y)], labels: ["time", "mean square displacement"],
                    series: [{ kind: "points", x: c.x, y: c.y }] })
            },
        }],
        numbers(page) {
            const q = page.scenes.fluid.quantities()
            return [["", "measured"], ["diffusion constant D", Live.withError(q.diffusion_constant)], ["pressure", Live.withError(q.pressure)],
                ["bond order q6, of a particle and its neighbours", Live.withError(q.local_q6)], ["temperature kT (set: 0.1)", Live.withError(q.kinetic_temperature)]]
        },
        summary: page => `Diffusion constant ${Live.withError(page.scenes.fluid.quantities().diffusion_constant)} with ${page.values.atoms} atoms per particle.`,
        command: v => run("freeze", Live.pages.freeze.set(v)),
    }

    // NG2007, "Other thermostats"
    const ways = { global: "all with one factor", layers: "layer by layer", monte_carlo: "Monte Carlo" }
    Live.pages.rescale = {
        files: { global: "rescale", layers: "rescale", monte_carlo: "rescale" },
        endless: true,
        controls: [
            { name: "force", label: "acceleration of the flow", from: 0, to: 0.2, value: 0.1 },
            { name: "repulsion", label: "repulsion a", from: 5, to: 50, value: 25 },
        ],
        set: (v, key) => [`rescale.mode=${key}`, `body_force.acceleration=${v.force}`, `verlet.soft.strength=${v.repulsion}`],
        views: [{
            label: "Particles of the fluid whose velocities are all rescaled by one factor.",
            caption: "Two opposed flows (lower half to the right, upper to the left), all velocities rescaled by one factor: coloured by speed, which here is flow and heat.",
            draw: (canvas, page) => Live.particles(canvas, page.scenes.global, { kT: 2 }),
        }, {
            label: "Temperature across the flow.",
            caption: "Temperature against y by the three ways of rescaling. Heat is made where the two flows meet, at the ends and in the middle of the axis; one factor for all takes it away everywhere alike.",
            draw(canvas, page) {
                const curves = Object.keys(ways).map(key => ({ name: ways[key], kind: "points", ...page.scenes[key].curve("temperature_profile") }))
                const top = Math.max(1.5, ...curves.flatMap(c => c.y.map(Live.number).filter(Number.isFinite))) * 1.5
                Live.plot(canvas, { x: [0, 20], y: [0, top], labels: ["y", "temperature kT"], series: curves.map(c => ({ ...c, error: c.error.map(Live.number) })) })
            },
        }],
        numbers(page) {
            return [["rescaling", "mean kT", "share of cos(4πy/L)"], ...Object.keys(ways).map(key => {
                const q = page.scenes[key].quantities()
                return [ways[key], Live.withError(q.profile_temperature), Live.withError(q.temperature_modulation)]
            })]
        },
        summary: page => "Modulation of the temperature: " + Object.keys(ways).map(key => `${ways[key]} ${Live.withError(page.scenes[key].quantities().temperature_modulation)}`).join(", ") + ".",
        command: v => Object.keys(ways).map(key => run("rescale", Live.pages.rescale.set(v, key))).join("\n"),
    }

    // the introduction's pair; with fewer blocks than these its error is itself unknown: two particles have one energy, and it lives long
    const settledBlocks = 16
    const ofPair = page => {
        const q = kT(page.scenes.pair)
        return q && q[2] < settledBlocks ? text(q[0]) + " ± …" : Live.withError(q)
    }
    Live.pages.pair = {
        files: { pair: "pair" },
        endless: true,
        controls: [
            { name: "friction", label: "friction γ", from: 0.5, to: 20, value: 4, log: true },
            { name: "kT", label: "temperature that the noise is made for, σ²/(2γ)", from: 0.1, to: 3, value: 1 },
            { name: "withFriction", label: "friction", value: true },
            { name: "withNoise", label: "noise", value: true },
        ],
        set: v => [`euler.gamma=${v.withFriction ? v.friction : 0}`, `euler.sigma=${v.withNoise ? Number(Math.sqrt(2 * v.friction * v.kT).toPrecision(7)) : 0}`],
        pace: 25,
        buttons: [{ text: "Hurry, or slowly", action: page => { page.pace = page.pace ? 0 : 25 } }],
        begun() { this.trace = [] },
        views: [{
            label: "Two particles in a small periodic box; a line joins them while they touch.",
            caption: "Two particles alone. While they are closer than the cutoff, a line joins them, and along it friction and noise act.",
            draw(canvas, page) {
                const { context: c, width, height } = Live.prepare(canvas, 0.7)
                const scene = page.scenes.pair, { length } = scene.state(), r = scene.positions()
                const scale = height / length[1], left = (width - height) / 2, { series, line, ink } = Live.colours()
                const d = [r[2] - r[0], r[3] - r[1]].map((x, axis) => x - length[axis] * Math.round(x / length[axis]))
                c.strokeStyle = line
                c.strokeRect(left + 0.5, 0.5, height - 1, height - 1)
                c.save(); c.beginPath(); c.rect(left, 0, height, height); c.clip()
                for (const dx of [-1, 0, 1]) for (const dy of [-1, 0, 1]) {
                    const x = left + scale * (r[0] + dx * length[0]), y = height - scale * (r[1] + dy * length[1])
                    const x2 = x + scale * d[0], y2 = y - scale * d[1]
                    if (Math.hypot(...d) < 1) { c.strokeStyle = ink; c.lineWidth = 2; c.beginPath(); c.moveTo(x, y); c.lineTo(x2, y2); c.stroke() }
                    ;[[x, y], [x2, y2]].forEach(([a, b], k) => { c.fillStyle = series[k]; c.beginPath(); c.arc(a, b, 0.09 * scale, 0, 7); c.fill() })
                }
                c.restore()
            },
        }, {
            label: "Temperature of the pair, its mean so far, against time.",
            caption: "The mean of the pair's temperature so far, against time. Dashed: σ²/(2γ).",
            draw(canvas, page) {
                const t = page.trace.map(p => p[0]), y = page.trace.map(p => p[1]), last = Math.max(50, t[t.length - 1] || 0)
                Live.plot(canvas, { x: [0, last], y: [0, 1.3 * Math.max(1.5 * page.values.kT, ...y)], labels: ["time", "mean kT so far"],
                    series: [{ name: "measured", kind: "line", x: t, y }, { name: "σ²/(2γ)", kind: "line", dashed: true, colour: Live.colours().faint, x: [0, last], y: [page.values.kT, page.values.kT] }] })
            },
        }],
        sampled() {
            const q = kT(this.scenes.pair)
            if (q) this.trace.push([this.scenes.pair.state().measured_steps * 0.004, q[0]])
            if (this.trace.length > 400) this.trace = this.trace.filter((_, k) => k % 2)
        },
        numbers: page => [["", "measured", "expected"], ["temperature, mean so far", ofPair(page),
            page.values.withFriction && page.values.withNoise ? text(page.values.kT) : page.values.withFriction ? "falls to 0" : page.values.withNoise ? "rises without end" : "stays"],
            ["temperature now", text(page.scenes.pair.state().kT), ""]],
        summary: page => `The pair's mean temperature is ${ofPair(page)}.`,
        command: v => run("pair", Live.pages.pair.set(v)),
    }
}
