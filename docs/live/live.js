// The live pages' common part: the engine, a run that only works while someone looks, sliders, numbers, particles and curves.
// Each page is a description in live_pages.js; the engine is dpdref itself, compiled to WebAssembly (live_engine.js), and
// live_scenes.js holds the scenes of verification/scenes/live. All are scripts, not data that is fetched, so that they
// work from the file system. Where a page has no engine its picture stays.
const Live = {
    pages: {},

    // --- the engine -------------------------------------------------------------------------------------------------

    load: source => new Promise((done, failed) => {
        const script = document.createElement("script")
        script.src = source
        script.onload = done
        script.onerror = () => failed(new Error(source))
        document.head.append(script)
    }),

    // The engine's text as a script of its own: of the page, and of a worker for what takes seconds.
    source: (...parts) => URL.createObjectURL(new Blob(parts, { type: "text/javascript" })),

    // The engine's WebAssembly: a page opened from the file system may read no other file, so it comes packed in a script.
    async unpacked() {
        const packed = Uint8Array.from(atob(window.liveEngine.packed), letter => letter.charCodeAt(0))
        const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))
        return new Uint8Array(await new Response(stream).arrayBuffer())
    },

    // Closed forms that take seconds, [[id, assignments], ...], away from the page; `done(values)`.
    slowTheory(asked, done) {
        const work = `onmessage = ({ data }) => DpdrefEngine({ wasmBinary: data }).then(module => {
            const theory = module.cwrap("live_theory", "string", ["string", "string"])
            postMessage(${JSON.stringify(asked)}.map(([id, given]) => JSON.parse(theory(id, given.join("\\n"))).value))
        })`
        const worker = new Worker(Live.source(window.liveEngine.script, "\n", work))
        worker.onmessage = message => { worker.terminate(); done(message.data.map(Live.number)) }
        worker.onerror = () => { worker.terminate(); done(asked.map(() => NaN)) }
        worker.postMessage(Live.wasmBinary)
        return worker
    },

    // What src/live/interface.cpp offers, as JavaScript.
    wrap(module) {
        const call = (name, result, ...types) => module.cwrap("live_" + name, result, types)
        const begin = call("begin", "number", "string", "string"), message = call("message", "string")
        const change = call("change", "number", "number", "string"), advance = call("advance", "number", "number", "number")
        const again = call("measure_again", "number", "number"), end = call("end", null, "number")
        const state = call("state", "string", "number"), quantities = call("quantities", "string", "number")
        const curve = call("curve", "string", "number", "string"), theory = call("theory", "string", "string", "string")
        const positions = call("positions", "number", "number"), velocities = call("velocities", "number", "number")
        const lines = overrides => overrides.join("\n")
        class Scene {
            constructor(text, overrides) {
                this.number = begin(text, lines(overrides))
                if (!this.number) throw new Error(message())
                this.status = 0
            }
            change(overrides) {
                const status = change(this.number, lines(overrides))
                if (status === 2) throw new Error(message())
                this.status = status
            }
            // 0 running, 1 complete, 3 diverged: then `said` tells when
            advance(steps) {
                this.status = advance(this.number, steps)
                if (this.status > 1) this.said = message()
                return this.status
            }
            again() { again(this.number) }
            end() { end(this.number) }
            state() { return JSON.parse(state(this.number)) }
            quantities() { return JSON.parse(quantities(this.number)) }
            curve(name) { return JSON.parse(curve(this.number, name)) }
            array(pointer) {
                const { particles, dimension } = this.state()
                return module.HEAPF64.slice(pointer >> 3, (pointer >> 3) + particles * dimension)
            }
            positions() { return this.array(positions(this.number)) }
            velocities() { return this.array(velocities(this.number)) }
        }
        return {
            Scene,
            // the value of a closed form, or NaN where it has none
            theory: (id, given) => Live.number(JSON.parse(theory(id, lines(given))).value),
        }
    },
    number: value => typeof value === "number" ? value : NaN,

    // --- text of numbers --------------------------------------------------------------------------------------------

    text(value, digits = 3) {
        if (!Number.isFinite(value)) return "–"
        const size = Math.abs(value)
        return size !== 0 && (size < 1e-4 || size >= 1e5) ? value.toExponential(digits - 1)
            : String(Number(value.toPrecision(Math.max(digits, Math.ceil(Math.log10(Math.max(1, size)))))))
    },
    // value(error in units of the last digit)
    withError(quantity) {
        if (!quantity) return "…"
        const [value, error] = quantity
        if (!Number.isFinite(value)) return "–"
        if (!(error > 0)) return Live.text(value) + " ± …"
        const decimals = Math.max(0, Math.min(8, 1 - Math.floor(Math.log10(error))))
        return value.toFixed(decimals) + " ± " + error.toFixed(decimals)
    },

    // --- drawing ----------------------------------------------------------------------------------------------------

    colours() {
        const of = getComputedStyle(document.documentElement)
        const dark = document.documentElement.classList.contains("dark-mode")
        return {
            ink: of.getPropertyValue("--page-foreground-color").trim() || "#222",
            faint: of.getPropertyValue("--page-secondary-foreground-color").trim() || "#777",
            line: of.getPropertyValue("--separator-color").trim() || "#ccc",
            back: of.getPropertyValue("--page-background-color").trim() || "#fff",
            series: dark ? ["#6ab0f3", "#f2a154", "#7fcf9a", "#d79be0"] : ["#1f6fb5", "#c2570c", "#1d8348", "#8e44ad"],
            // slow to fast
            speeds: dark ? ["#3b5b8c", "#4a78b5", "#5f98c9", "#86b6c4", "#c0bd92", "#e3a65a", "#f08a3c", "#ff6a2b"]
                : ["#1d4e89", "#2a6cab", "#4889b8", "#7aa2ad", "#ad9a72", "#cf8440", "#dd6620", "#d9480f"],
        }
    },

    // A canvas as sharp as the screen; returns its context and its size in CSS pixels.
    prepare(canvas, ratio) {
        const width = canvas.clientWidth, height = Math.round(width * ratio), sharp = window.devicePixelRatio || 1
        if (canvas.width !== Math.round(width * sharp) || canvas.height !== Math.round(height * sharp)) {
            canvas.width = Math.round(width * sharp)
            canvas.height = Math.round(height * sharp)
        }
        const context = canvas.getContext("2d")
        context.setTransform(sharp, 0, 0, sharp, 0, 0)
        context.clearRect(0, 0, width, height)
        return { context, width, height }
    },

    // The particles, x to the right and y up, coloured by their speed over the thermal one; a third dimension is depth.
    particles(canvas, scene, { kT = 1, size = 0.24, flow = 0 } = {}) {
        const { dimension, length } = scene.state(), ratio = length[1] / length[0]
        const tall = Math.min(ratio, 1)
        const { context, width, height } = Live.prepare(canvas, tall)
        const scale = Math.min(width / length[0], height / length[1]), left = (width - scale * length[0]) / 2
        const r = scene.positions(), v = scene.velocities(), colour = Live.colours().speeds
        const heaps = colour.map(() => [])
        for (let p = 0; p < r.length; p += dimension) {
            let square = 0
            for (let axis = 0; axis < dimension; axis++) {
                const u = v[p + axis] - (axis === 0 ? flow * (r[p + 1] - length[1] / 2) : 0)
                square += u * u
            }
            heaps[Math.min(colour.length - 1, Math.floor(2.7 * Math.sqrt(square / (dimension * kT))))].push(p)
        }
        const radius = Math.max(1.1, size * scale)
        context.save()
        context.beginPath()
        context.rect(left, height - scale * length[1], scale * length[0], scale * length[1])
        context.clip()
        heaps.forEach((heap, k) => {
            context.fillStyle = colour[k]
            context.globalAlpha = dimension === 3 ? 0.75 : 0.9
            context.beginPath()
            for (const p of heap) {
                const x = left + scale * r[p], y = height - scale * r[p + 1]
                const near = dimension === 3 ? 0.55 + 0.45 * r[p + 2] / length[2] : 1
                context.moveTo(x + radius * near, y)
                context.arc(x, y, radius * near, 0, 2 * Math.PI)
            }
            context.fill()
        })
        context.restore()
        context.strokeStyle = Live.colours().line
        context.strokeRect(left + 0.5, height - scale * length[1] + 0.5, scale * length[0] - 1, scale * length[1] - 1)
    },

    ticks(from, to, log) {
        if (log) {
            const found = []
            for (let k = Math.ceil(Math.log10(from) - 1e-9); k <= Math.log10(to) + 1e-9; k++) found.push(10 ** k)
            return found
        }
        const raw = (to - from) / 5, power = 10 ** Math.floor(Math.log10(raw))
        const step = [1, 2, 5, 10].map(k => k * power).find(k => k >= raw)
        const found = []
        for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step; k++) found.push(k * step)
        return found
    },

    // Curves: {x: [from, to], y: [from, to], logX, logY, labels: [x, y], marks: [{x, text}], lowKey: the key at the lower left,
    // series: [{name, x, y, error, kind: "line" | "points" | "open", dashed, colour, faint}]}
    plot(canvas, { x, y, logX = false, logY = false, labels, series, marks = [], lowKey = false }) {
        const { context: c, width, height } = Live.prepare(canvas, 0.8)
        const { ink, faint, line, back, series: palette } = Live.colours()
        const box = { left: 54, right: width - 18, top: 12, bottom: height - 42 }
        const to = (range, log, a, b) => value => {
            const [from, until] = log ? range.map(Math.log10) : range
            return a + ((log ? Math.log10(value) : value) - from) / (until - from) * (b - a)
        }
        const px = to(x, logX, box.left, box.right), py = to(y, logY, box.bottom, box.top)
        c.font = "12px sans-serif"
        c.lineWidth = 1
        c.strokeStyle = line
        c.fillStyle = faint
        c.textAlign = "center"
        for (const t of Live.ticks(...x, logX)) {
            c.beginPath(); c.moveTo(px(t), box.bottom); c.lineTo(px(t), box.top); c.stroke()
            c.fillText(Live.text(t), px(t), box.bottom + 15)
        }
        c.textAlign = "right"
        for (const t of Live.ticks(...y, logY)) {
            c.beginPath(); c.moveTo(box.left, py(t)); c.lineTo(box.right, py(t)); c.stroke()
            c.fillText(Live.text(t), box.left - 5, py(t) + 4)
        }
        c.fillStyle = ink
        c.textAlign = "center"
        c.fillText(labels[0], (box.left + box.right) / 2, height - 8)
        c.save(); c.translate(12, (box.top + box.bottom) / 2); c.rotate(-Math.PI / 2); c.fillText(labels[1], 0, 0); c.restore()
        c.save()
        c.beginPath(); c.rect(box.left, box.top, box.right - box.left, box.bottom - box.top); c.clip()
        for (const mark of marks) {
            c.strokeStyle = ink
            c.setLineDash([2, 3])
            c.beginPath(); c.moveTo(px(mark.x), box.top); c.lineTo(px(mark.x), box.bottom); c.stroke()
            c.setLineDash([])
            c.fillStyle = ink
            c.textAlign = px(mark.x) > (box.left + box.right) / 2 ? "right" : "left"
            c.fillText(mark.text, px(mark.x) + (c.textAlign === "right" ? -5 : 5), box.bottom - 8)
        }
        series.forEach((s, number) => {
            c.strokeStyle = c.fillStyle = s.colour || palette[number % palette.length]
            c.globalAlpha = s.faint ? 0.45 : 1
            c.lineWidth = s.kind === "line" ? 1.8 : 1.3
            const shown = s.x.map((value, k) => [value, s.y[k], s.error ? s.error[k] : 0])
                .filter(([a, b]) => Number.isFinite(a) && Number.isFinite(b) && (!logX || a > 0) && (!logY || b > 0))
            if (s.kind === "line") {
                c.setLineDash(s.dashed ? [6, 4] : [])
                c.beginPath()
                shown.forEach(([a, b], k) => k ? c.lineTo(px(a), py(b)) : c.moveTo(px(a), py(b)))
                c.stroke()
                c.setLineDash([])
            } else for (const [a, b, e] of shown) {
                if (e > 0) {
                    c.beginPath(); c.moveTo(px(a), py(logY ? Math.max(b - e, y[0]) : b - e)); c.lineTo(px(a), py(b + e)); c.stroke()
                }
                c.beginPath(); c.arc(px(a), py(b), 3.6, 0, 2 * Math.PI)
                if (s.kind === "open") { c.save(); c.fillStyle = Live.colours().back; c.fill(); c.restore(); c.stroke() } else c.fill()
            }
            c.globalAlpha = 1
        })
        c.restore()
        // the key, which a narrow screen may lay over a curve, and so on a ground of its own
        const named = series.filter(s => s.name), tall = 16 * named.length
        let row = lowKey ? box.bottom - tall + 6 : box.top + 14
        if (named.length) {
            c.globalAlpha = 0.8
            c.fillStyle = back
            c.fillRect(box.left + 1, row - 13, 40 + Math.max(...named.map(s => c.measureText(s.name).width)), tall + 2)
            c.globalAlpha = 1
        }
        series.forEach((s, number) => {
            if (!s.name) return
            c.strokeStyle = c.fillStyle = s.colour || palette[number % palette.length]
            c.lineWidth = 1.8
            if (s.kind === "line") {
                c.setLineDash(s.dashed ? [5, 3] : [])
                c.beginPath(); c.moveTo(box.left + 8, row - 4); c.lineTo(box.left + 28, row - 4); c.stroke()
                c.setLineDash([])
            } else {
                c.beginPath(); c.arc(box.left + 18, row - 4, 3.6, 0, 2 * Math.PI)
                s.kind === "open" ? c.stroke() : c.fill()
            }
            c.fillStyle = ink
            c.textAlign = "left"
            c.fillText(s.name, box.left + 34, row)
            row += 16
        })
    },

    // --- a page -----------------------------------------------------------------------------------------------------

    element(tag, attributes = {}, ...children) {
        const made = document.createElement(tag)
        for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value)
        made.append(...children)
        return made
    },

    // A slider of {name, label, unit, from, to, value, log, integer}
    slider(page, of) {
        const id = `live-${page.name}-${of.name}`, steps = 200
        const inside = k => of.log ? of.from * (of.to / of.from) ** (k / steps) : of.from + (of.to - of.from) * k / steps
        const valueOf = k => of.integer ? Math.round(inside(k)) : Number(inside(k).toPrecision(3))
        const place = v => Math.round(steps * (of.log ? Math.log(v / of.from) / Math.log(of.to / of.from) : (v - of.from) / (of.to - of.from)))
        const input = Live.element("input", { type: "range", id, min: 0, max: steps, step: 1, value: place(of.value) })
        const output = Live.element("output", { for: id })
        const show = () => {
            output.textContent = Live.text(page.values[of.name]) + (of.unit ? " " + of.unit : "")
            input.setAttribute("aria-valuetext", output.textContent)
        }
        page.values[of.name] = of.value
        input.addEventListener("input", () => {
            page.values[of.name] = valueOf(Number(input.value))
            show()
            page.changed()
        })
        show()
        return Live.element("div", { class: "live-slider" }, Live.element("label", { for: id }, of.label), input, output)
    },

    switch(page, of) {
        const id = `live-${page.name}-${of.name}`
        const input = Live.element("input", { type: "checkbox", id })
        input.checked = page.values[of.name] = of.value
        input.addEventListener("change", () => { page.values[of.name] = input.checked; page.changed() })
        return Live.element("div", { class: "live-switch" }, input, Live.element("label", { for: id }, of.label))
    },

    button(text, action) {
        const made = Live.element("button", { type: "button" }, text)
        made.addEventListener("click", action)
        return made
    },

    start(place, engine) {
        const name = place.dataset.live
        const page = Object.assign(Object.create(Live.pages[name]), { name, engine, values: {}, scenes: {}, place })
        const { element } = Live
        const still = matchMedia("(prefers-reduced-motion: reduce)").matches
        let playing = !still, inView = false, read = 0, spoken = 0, frames = 0, since = 0, busy = 1, settle = 0, waiting = false

        // parts
        const canvases = page.views.map(view => element("canvas", { role: "img", "aria-label": view.label }))
        const figures = page.views.map((view, k) => element("figure", { class: view.wide ? "live-wide" : "" }, canvases[k],
            element("figcaption", {}, view.caption)))
        const controls = page.controls.map(of => typeof of.value === "boolean" ? Live.switch(page, of) : Live.slider(page, of))
        const play = Live.button("", () => { playing = !playing; shown() })
        const note = element("p", { class: "live-note", role: "status", "aria-live": "polite" })
        const table = element("table", { class: "live-numbers" })
        const said = element("p", { class: "live-said", "aria-live": "polite" })
        const command = element("pre", { class: "fragment live-command", tabindex: 0, "aria-label": "the same with dpdref" })
        const shown = () => {
            play.textContent = playing ? "Pause" : "Run"
            place.dataset.playing = playing
            if (playing) next()
        }
        const buttons = [play, Live.button("Begin again", () => begin()),
            ...(page.buttons || []).map(each => Live.button(each.text, () => { each.action(page, write); draw(); write() }))]
        const stage = element("div", { class: page.views.length === 1 ? "live-stage live-single" : "live-stage" }, element("div", { class: "live-views" }, ...figures),
            element("div", { class: "live-controls" }, ...controls, element("div", { class: "live-buttons" }, ...buttons), note, table),
            said, ...(page.command ? [element("p", { class: "live-same" }, "The same from the command line:"), command] : []))
        if (page.doors) stage.append(element("nav", { class: "live-doors", "aria-label": "where to go from here" },
            ...page.doors.map(([text, href]) => element("a", { href }, text))))
        place.append(stage)
        place.classList.add("live-running")

        // what a scene gets beyond its file
        const overrides = key => page.set(page.values, key)
        const begin = () => {
            for (const [key, file] of Object.entries(page.files)) {
                if (page.scenes[key]) page.scenes[key].end()
                page.scenes[key] = new engine.Scene(window.liveScenes[file], overrides(key))
            }
            note.textContent = ""
            if (page.begun) page.begun()
            draw(); write()
        }
        page.restart = begin
        // a slider that moves changes the scenes a moment later, since each change measures anew
        page.changed = () => {
            clearTimeout(settle)
            settle = setTimeout(() => {
                if (page.leaving) page.leaving()
                try {
                    for (const [key, scene] of Object.entries(page.scenes)) {
                        if (scene.status === 3 || (page.fresh && page.fresh())) { begin(); break }
                        scene.change(overrides(key))
                    }
                    note.textContent = ""
                    if (page.begun) page.begun()
                } catch (error) { note.textContent = error.message }
                draw(); write(); spoken = 0
            }, 150)
            tell()
        }
        const tell = () => {
            if (page.command) {
                command.textContent = page.command(page.values)
                foldCode(command, 30)  // docs/reader.js
            }
        }
        const draw = () => page.views.forEach((view, k) => view.draw(canvases[k], page))
        const write = () => {
            const rows = page.numbers(page), settling = "The fluid settles; then it is measured."
            const settles = Object.values(page.scenes).some(scene => scene.status === 0 && scene.state().measured_steps === 0)
            if (settles && !note.textContent) note.textContent = settling
            if (!settles && note.textContent === settling) note.textContent = ""
            table.replaceChildren(...rows.map((row, k) => element("tr", {}, ...row.map((cell, column) =>
                element(k === 0 ? "th" : column === 0 ? "th" : "td", k === 0 ? { scope: "col" } : column === 0 ? { scope: "row" } : {}, cell)))))
            page.views.forEach((view, k) => { if (view.says) canvases[k].setAttribute("aria-label", view.label + " " + view.says(page)) })
        }
        const frame = now => {
            if (!playing || !inView || document.hidden) { since = 0; return }
            if (since === 0) { since = now; frames = 0 }
            // as many steps as fit into two thirds of a frame of a thirtieth of a second
            const until = performance.now() + 20
            let steps = 0, over = true
            do {
                over = true
                for (const scene of Object.values(page.scenes))
                    if (scene.status === 0) { scene.advance(busy); over = false }
                steps += busy
            } while (!over && performance.now() < until && !(page.pace && steps >= page.pace))
            const each = 20 / Math.max(1, steps)
            busy = Math.max(1, Math.min(50, Math.floor(2 / each)))
            for (const scene of Object.values(page.scenes)) {
                if (scene.status === 1 && page.endless) { scene.again(); scene.status = 0; if (page.begun) page.begun() }
                if (scene.status === 3) note.textContent = page.boiled ? page.boiled(scene) : scene.said
            }
            draw()
            if (now - read > 500) { read = now; if (page.sampled) page.sampled(); write() }
            if (now - spoken > 15000) { spoken = now; said.textContent = page.summary(page) }
            frames++
            if (now - since > 1000) { place.dataset.rate = (1000 * frames / (now - since)).toFixed(1); since = now; frames = 0 }
            if (over && !page.endless) { playing = false; if (!note.textContent) note.textContent = "Measured to its end: begin again, or move a slider."; shown() }
            else next()
        }
        const next = () => {
            if (waiting) return
            waiting = true
            requestAnimationFrame(now => { waiting = false; frame(now) })
        }

        new IntersectionObserver(entries => {
            inView = entries.some(entry => entry.isIntersecting)
            if (inView && playing) next()
        }).observe(stage)
        document.addEventListener("visibilitychange", () => { if (!document.hidden && playing) next() })
        new ResizeObserver(() => draw()).observe(stage)
        new MutationObserver(() => draw()).observe(document.documentElement, { attributeFilter: ["class"] })
        Object.defineProperty(place, "live", { value: page })
        begin(); tell(); shown()
        if (still) note.textContent = "Your system asks for little motion: nothing moves until you press Run."
    },

    async open() {
        const places = [...document.querySelectorAll("[data-live]")]
        if (!places.length) return
        if (!window.liveScenes) {
            const why = "Here the engine would run in this page; the book was built without emscripten, and its figures stand for it."
            for (const place of places) place.append(Live.element("p", { class: "live-still" }, why))
            return
        }
        try {
            await Live.load("live_engine.js")
            await Live.load(Live.source(window.liveEngine.script))
            Live.wasmBinary = await Live.unpacked()
            const engine = Live.wrap(await window.DpdrefEngine({ wasmBinary: Live.wasmBinary }))
            for (const place of places) Live.start(place, engine)
        } catch (error) {
            console.error("live pages: " + error.message)
        }
    },
}
addEventListener("DOMContentLoaded", Live.open)
