// The head of every page: dark mode, solutions that unfold, and the search over pages, figures, equations and names.
// The index is a script, not data that is fetched, so that it works from the file system.
DoxygenAwesomeDarkModeToggle.init()
DoxygenAwesomeFragmentCopyButton.init()
DoxygenAwesomeParagraphLink.init()

// Paper is white, and has no folds.
const scheme = document.documentElement.classList
let before = ""
const solutions = open => document.querySelectorAll("details.solution").forEach(each => { each.open = open })
addEventListener("beforeprint", () => {
    before = scheme.value
    scheme.remove("dark-mode")
    scheme.add("light-mode")
    solutions(true)
})
addEventListener("afterprint", () => { scheme.value = before; solutions(false) })
// Formulas are set while solutions are open, since what is hidden has no size.
addEventListener("load", () => {
    if (window.MathJax) MathJax.Hub.Register.StartupHook("End", () => solutions(false))
    else solutions(false)
})

// Where code in the text may end a line: a command never within an option (`--set`), a long name behind its joints and not within a word.
const foldCode = (code, long) => {  // `long`: from how many letters on a word has joints
    const walk = document.createTreeWalker(code, NodeFilter.SHOW_TEXT), texts = []
    while (walk.nextNode()) texts.push(walk.currentNode)
    for (const text of texts) {
        const parts = text.data.split(/((?<![\w-])--?[a-z][\w-]*(?!\S)|\S+)/)
        text.replaceWith(...parts.flatMap((part, at) => {
            if (at % 2 && /^--?[a-z][\w-]*$/.test(part)) {
                const option = document.createElement("span")
                option.className = "option"
                option.textContent = part
                return option
            }
            if (part.length < long) return part
            return part.split(/(?<=[_/,=]|::)(?!$)|(?<=\.)(?=[a-z_]{4})/).flatMap((piece, i) => i ? [document.createElement("wbr"), piece] : piece)
        }))
    }
}
addEventListener("DOMContentLoaded", () => {
    for (const code of document.querySelectorAll("div.contents code, div.contents pre.fragment, div.contents a.el")) {
        if (code.closest("div.fragment, .memproto")) continue
        if (code.matches("pre")) foldCode(code, code.closest("details") ? 30 : Infinity)  // other commands are not folded but scroll
        else foldCode(code, code.closest("td, th") ? 13 : 24)
    }
})

// Doxygen puts a space before every formula, behind a bracket, too. MathJax sets them later.
addEventListener("DOMContentLoaded", () => {
    const walk = document.createTreeWalker(document.querySelector("div.contents") || document.body, NodeFilter.SHOW_TEXT)
    while (walk.nextNode())
        if (walk.currentNode.data.includes("( \\(")) walk.currentNode.data = walk.currentNode.data.replaceAll("( \\(", "(\\(")
})

// On a phone a column of sentences is as wide as a sentence needs, and the table scrolls.
addEventListener("DOMContentLoaded", () => {
    for (const table of document.querySelectorAll("table.markdownTable")) {
        const rows = [...table.rows].map(row => [...row.cells])
        rows[0]?.forEach((_, at) => {
            const column = rows.map(row => row[at]).filter(cell => cell), longest = Math.max(...column.map(cell => cell.textContent.trim().length))
            if (longest > 12) column.forEach(cell => cell.classList.add(longest > 60 ? "sentences" : longest > 25 ? "phrases" : "words"))
        })
    }
})

// The sidebar shows the parts of the book from the beginning; Doxygen makes its items some time after the page is loaded.
addEventListener("load", () => {
    const unfold = tries => {
        const book = document.querySelector('#nav-tree a[class="book.html"]'), arrow = book && book.closest(".item").querySelector(".arrow")
        if (!arrow && tries) setTimeout(unfold, 50, tries - 1)
        else if (arrow && arrow.textContent === "\u25ba") arrow.parentElement.click()
    }
    unfold(100)
})

const BookSearch = {
    // `Figure 3b` and `equation 12` are `Fig. 3b` and `eq. 12`
    words: text => (text.toLowerCase().normalize("NFKD").replace(/[\u0300-\u036f]/g, "").match(/[\p{L}\p{N}]+/gu) || [])
        .map(word => ({ figure: "fig", figs: "fig", figures: "fig", equation: "eq", equations: "eq", eqs: "eq" }[word] || word)),

    // The entries that have all words of the query, best first: a word of the title counts more than the beginning of
    // one, that more than the text; words that stand together in this order, and what much of the book leads to, count more;
    // figures and equations come first when a number is asked for, what proves or defines something last.
    find(query, entries) {
        const wanted = BookSearch.words(query)
        if (!wanted.length) return []
        const number = wanted.some(word => /\d/.test(word)), phrase = " " + wanted.join(" ")
        const found = []
        for (const entry of entries) {
            if (!entry.words) {
                entry.words = BookSearch.words(entry.kind === "figure" ? entry.title + " " + entry.url.split("#")[1] : entry.title)
                entry.body = ` ${BookSearch.words(entry.text).join(" ")} `
            }
            let score = { page: 8, word: 7, figure: number ? 20 : 4, equation: number ? 20 : 2, section: 3, claim: -8, definition: -8, code: -15 }[entry.kind]
            for (const word of wanted) {
                if (entry.words.includes(word)) score += 20
                else if (word.length > 1 && entry.words.some(w => w.startsWith(word))) score += 10
                else if (entry.body.includes(word.length > 1 ? word : ` ${word} `)) score += 1
                else { score = -Infinity; break }
            }
            if (score < -20) continue
            if (wanted.length > 1) score += (" " + entry.words.join(" ")).includes(phrase) ? 8 : entry.body.includes(phrase) ? 4 : 0
            if (entry.words[0] === wanted[0]) score += 3
            found.push({ entry, score: score - 0.2 * entry.words.length + 0.5 * Math.log2(1 + entry.links) })
        }
        return found.sort((a, b) => b.score - a.score).slice(0, 20).map(each => each.entry)
    },

    load: () => BookSearch.loading ||= new Promise(done => {
        const script = document.createElement("script")
        script.src = BookSearch.root + "search_index.js"
        script.onload = () => done(window.bookIndex.map(([url, kind, title, page, text, links]) => ({ url, kind, title, page, text, links })))
        document.head.append(script)
    }),

    excerpt(entry, query) {
        const text = entry.text.toLowerCase(), word = BookSearch.words(query).find(w => text.includes(w))
        const at = word && entry.kind !== "word" ? Math.max(0, text.indexOf(word) - 40) : 0
        return (at ? "…" : "") + entry.text.slice(at, at + 110) + (entry.text.length > at + 110 ? "…" : "")
    },

    async show() {
        const field = document.getElementById("search-field"), list = document.getElementById("search-results")
        const query = field.value
        const found = query.trim() ? BookSearch.find(query, await BookSearch.load()) : []
        if (query !== field.value) return  // typed on meanwhile
        list.replaceChildren(...found.map(entry => {
            const link = document.createElement("a"), text = document.createElement("span")
            link.href = BookSearch.root + entry.url
            link.textContent = entry.title
            text.textContent = (entry.page && entry.page !== entry.title ? entry.page + ": " : "") + BookSearch.excerpt(entry, query)
            link.append(text)
            const item = document.createElement("li")
            item.append(link)
            return item
        }))
        if (query.trim() && !found.length) list.textContent = "nothing found"
        list.hidden = !query.trim()
    },

    start() {
        const field = document.getElementById("search-field"), list = document.getElementById("search-results")
        field.addEventListener("input", BookSearch.show)
        field.addEventListener("focus", BookSearch.show)
        document.addEventListener("click", event => { if (!event.target.closest("#search-row, #search-results")) list.hidden = true })
        document.addEventListener("keydown", event => {
            const links = [...list.querySelectorAll("a")], at = links.indexOf(document.activeElement)
            if (event.key === "Escape") { list.hidden = true; field.blur() }
            else if (event.key === "/" && !/INPUT|TEXTAREA/.test(document.activeElement.tagName)) { event.preventDefault(); field.focus() }
            else if (list.hidden) return
            else if (event.key === "ArrowDown" && links.length) { event.preventDefault(); links[(at + 1) % links.length].focus() }
            else if (event.key === "ArrowUp" && at >= 0) { event.preventDefault(); (links[at - 1] || field).focus() }
            else if (event.key === "Enter" && document.activeElement === field && links.length) { event.preventDefault(); links[0].click() }
        })
    },
}
addEventListener("DOMContentLoaded", BookSearch.start)
