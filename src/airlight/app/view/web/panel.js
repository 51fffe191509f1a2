/* The viewer's panel as HTML. The server declares sections of widgets (view/widgets.py) and says
   where marks and progress are; this builds and updates elements, and says what a hand changed. */

const CHUNK = 36000   // bytes of a file in one message, below what the server takes
const SVG = 'http://www.w3.org/2000/svg'

function make (tag, classes = '', text = '') {
  const element = document.createElement(tag)
  if (classes) { element.className = classes }
  if (text) { element.textContent = text }
  return element
}

function rounded (value) {
  const number = Number(Number(value).toPrecision(4))
  // What is small is written so that it fits a field.
  return number !== 0 && Math.abs(number) < 1e-3 ? number.toExponential(2) : String(number)
}

/* A slider's place, 0 to 1000, for a value, and back. */
function scale (widget) {
  const low = widget.log ? Math.max(widget.low, widget.high * 1e-7, 1e-9) : widget.low
  const ratio = Math.log(widget.high / low)
  const width = widget.high - widget.low
  return widget.log
    ? { place: v => v <= low ? 0 : 1000 * Math.log(v / low) / ratio, value: p => p <= 0 ? widget.low : low * Math.exp(ratio * p / 1000) }
    : { place: v => 1000 * (v - low) / width, value: p => low + width * p / 1000 }
}

function hex (colour) {
  const byte = v => Math.round(255 * Math.min(Math.max(v, 0), 1)).toString(16).padStart(2, '0')
  return '#' + colour.map(byte).join('')
}

/* Each kind: elements for `held`, and how they show a value. `say` tells the server. */
const KINDS = {
  flag (widget, say) {
    const box = make('input'); box.type = 'checkbox'
    box.onchange = () => say(box.checked)
    return { parts: [box], show: v => { box.checked = v } }
  },
  choice (widget, say) {
    const list = make('select')
    for (const choice of widget.choices) {
      const option = make('option', '', choice.split('/').pop()); option.value = choice
      list.append(option)
    }
    list.onchange = () => say(list.value)
    return { parts: [list], show: v => { list.value = v } }
  },
  text (widget, say) {
    const field = make('input'); field.type = 'text'
    field.onchange = () => say(field.value)
    return { parts: [field], show: v => { field.value = v } }
  },
  number (widget, say) {
    const field = make('input'); field.type = 'number'; field.step = 'any'
    field.onchange = () => { if (field.value !== '') { say(Number(field.value)) } }
    if (widget.low === undefined || widget.high === undefined) {
      field.style.flex = '1 1 0'
      return { parts: [field], show: v => { field.value = rounded(v) } }
    }
    const bar = make('input'); bar.type = 'range'; bar.min = 0; bar.max = 1000; bar.step = 'any'
    bar.setAttribute('aria-label', widget.label)
    const at = scale(widget)
    const now = () => {
      const value = at.value(Number(bar.value))
      return widget.kind === 'whole' ? Math.round(value) : value
    }
    bar.oninput = () => { field.value = rounded(now()); if (!widget.waits) { say(now()) } }
    bar.onchange = () => say(now())
    field.addEventListener('change', () => { bar.value = at.place(Number(field.value)) })
    return { parts: [bar, field], show: v => { bar.value = at.place(v); field.value = rounded(v) } }
  },
  vector (widget, say) {
    const fields = widget.value.map(() => make('input'))
    for (const field of fields) {
      field.type = 'number'; field.step = 'any'
      field.onchange = () => say(fields.map(f => Number(f.value)))
      scrubbed(field, widget.step || 0.01, () => say(fields.map(f => Number(f.value))))
    }
    return { parts: fields, show: v => v.forEach((x, i) => { fields[i].value = rounded(x) }) }
  },
  colour (widget, say) {
    const well = make('input'); well.type = 'color'
    const now = () => [1, 3, 5].map(i => parseInt(well.value.slice(i, i + 2), 16) / 255)
    well.oninput = () => { if (!widget.waits) { say(now()) } }
    well.onchange = () => say(now())
    return { parts: [well], show: v => { well.value = hex(v) } }
  },
  button (widget, say) {
    const button = make('button', '', widget.label)
    button.onclick = () => say(null)
    return { parts: [button], show: () => {} }
  },
  bar () {
    const bar = make('div', 'bar'); const length = make('i'); const text = make('b')
    bar.append(length, text)
    return { parts: [bar], show: v => { length.style.width = 100 * v[0] + '%'; text.textContent = v[1] } }
  },
  chart () {
    const image = make('img', 'chart'); image.alt = 'a slice of the grid, its colours and its densities'
    return { parts: [image], show: v => { if (image.src !== v) { image.src = v } } }
  },
  note () {
    const text = make('div', 'text')
    return { parts: [text], show: v => { text.textContent = v } }
  },
  sky: skyPad
}
KINDS.whole = KINDS.number

/* A drag sideways over a field changes it, a click types into it. */
function scrubbed (field, step, changed) {
  field.style.cursor = 'ew-resize'
  let from = null
  field.onpointerdown = e => { from = { x: e.clientX, value: Number(field.value), moved: false } }
  field.onpointermove = e => {
    if (!from || !(e.buttons & 1)) { from = null; return }
    if (!from.moved && Math.abs(e.clientX - from.x) < 4) { return }
    from.moved = true
    field.setPointerCapture(e.pointerId)
    field.value = rounded(from.value + step * (e.clientX - from.x))
    changed()
  }
  field.onpointerup = () => { if (from && from.moved) { field.blur() } from = null }
}

/* The sky seen from below the ground: where what shines stands. */
function skyPad (widget, say) {
  const pad = document.createElementNS(SVG, 'svg')
  pad.setAttribute('class', 'pad'); pad.setAttribute('viewBox', '-1.1 -1.1 2.2 2.2')
  pad.style.width = pad.style.height = '88px'
  pad.innerHTML = '<circle r="1" fill="#2a3038"/>' +
    [1, 0.667, 0.333].map(r => `<circle r="${r}" fill="none" stroke="#5a626e" stroke-width=".02"/>`).join('') +
    '<circle r=".13" fill="#f0b454"/>'
  const sun = pad.lastChild
  const text = make('div')
  const show = v => {
    const away = Math.min((90 - v[1]) / 90, 1.05); const a = v[0] * Math.PI / 180
    sun.setAttribute('cx', Math.sin(a) * away); sun.setAttribute('cy', Math.cos(a) * away)
    text.innerText = `azimuth ${v[0].toFixed(1)}°\nelevation ${v[1].toFixed(1)}°`
  }
  const point = e => {
    const box = pad.getBoundingClientRect()
    const x = 2.2 * (e.clientX - box.left) / box.width - 1.1
    const y = 2.2 * (e.clientY - box.top) / box.height - 1.1
    const up = Math.min(Math.max(90 * (1 - Math.hypot(x, y)), -5), 90)
    const angles = [Math.atan2(x, y) * 180 / Math.PI, up]
    show(angles); say(angles)
  }
  pad.onpointerdown = e => { pad.setPointerCapture(e.pointerId); point(e) }
  pad.onpointermove = e => { if (e.buttons & 1) { point(e) } }
  return { parts: [pad, text], show }
}

class AirlightPanel {
  /* `root` holds .stage, in which the streamed image is; `send` takes messages to the server. */
  constructor (root, stage, send, isCell) {
    this.root = root; this.stage = stage; this.send = send
    this.widgets = new Map(); this.made = ''; this.shut = new Map(); this.touches = new Map()
    this.isShown = true; this.canUse = true
    root.classList.add('airlight', isCell ? 'cell' : 'page')
    this.panel = make('aside', 'panel'); this.panel.hidden = true
    const head = make('div', 'head'); this.title = make('span')
    head.append(make('b', '', 'airlight'), this.title)
    this.error = make('div', 'said error'); this.notice = make('div', 'said notice')
    this.sections = make('div')
    this.panel.append(head, this.error, this.notice, this.sections)
    root.prepend(this.panel)
    this.marks = document.createElementNS(SVG, 'svg'); this.marks.setAttribute('class', 'marks')
    this.toggle = make('button', 'toggle', '☰'); this.toggle.title = 'Controls (tab)'
    this.toggle.onclick = () => { this.say('panel.shown', !this.isShown); this.giveKeys() }
    this.pill = make('div', 'pill'); this.help = make('div', 'help'); this.help.hidden = true
    stage.append(this.marks, this.toggle, this.pill, this.help)
    this.ending = new AbortController(); this.hasHadKeys = isCell
    this.takeTouches(); this.takeFiles(); this.takeTab()
    if (isCell) { new ResizeObserver(() => { this.panel.style.maxHeight = Math.max(stage.clientHeight, 260) + 'px' }).observe(stage) }
  }

  hello () {
    this.made = ''
    this.send({ type: 'hello', shown: this.root.classList.contains('page') && window.innerWidth >= 720 })
  }

  say (key, value) { this.send({ type: 'set', key, value }) }

  take (message) {
    if (!this.hasHadKeys) { this.giveKeys() }
    if (message.type === 'panel') { this.showSections(message.sections) }
    if (message.type === 'status') { this.showStatus(message) }
    if (message.type === 'marks') { this.showMarks(message.marks) }
    if (message.type === 'copy') { copied(message.text) }
  }

  showSections (sections) {
    const shape = JSON.stringify(sections.map(s => [s.name, s.widgets.map(w => [w.key, w.kind, w.label, w.low, w.high, w.choices])]))
    if (shape !== this.made) { this.made = shape; this.build(sections) }
    for (const section of sections) {
      for (const widget of section.widgets) {
        const own = this.widgets.get(widget.key)
        const isHeld = own.parts.some(part => part === document.activeElement || part.matches(':active'))
        // What a hand is at shows what the hand does; the server's answer is older than that.
        if (!isHeld || ['choice', 'flag', 'button'].includes(widget.kind)) { own.show(widget.value) }
      }
    }
  }

  build (sections) {
    const top = this.panel.scrollTop
    this.sections.textContent = ''; this.widgets.clear()
    for (const section of sections) {
      const fold = make('details'); const rows = make('div', 'rows')
      fold.open = this.shut.get(section.name) ?? section.open
      fold.ontoggle = () => this.shut.set(section.name, fold.open)
      fold.append(make('summary', '', section.name[0].toUpperCase() + section.name.slice(1)), rows)
      for (const widget of section.widgets) { rows.append(this.row(widget)) }
      this.sections.append(fold)
    }
    this.panel.scrollTop = top
  }

  row (widget) {
    const own = KINDS[widget.kind](widget, value => this.say(widget.key, value))
    this.widgets.set(widget.key, own)
    if (widget.kind === 'button') { own.parts[0].title = widget.tip; return own.parts[0] }
    const row = make('label', 'row'); row.title = widget.tip; row.dataset.key = widget.key
    const held = make('div', 'held ' + widget.kind)
    held.append(...own.parts)
    if (widget.label) { row.append(make('span', '', widget.label)) }
    row.append(held)
    return row
  }

  showStatus (status) {
    this.isShown = status.shown
    this.panel.hidden = !status.shown
    this.toggle.setAttribute('aria-expanded', status.shown)
    this.title.textContent = status.title
    this.error.textContent = [status.message, ...status.doubts].filter(Boolean).join('\n')
    this.notice.textContent = status.notice
    const text = status.shown ? status.notice || status.text : status.message || status.notice || status.text
    const length = make('i'); length.style.setProperty('--share', 100 * status.share + '%')
    this.pill.replaceChildren(length, make('span', '', text))
    this.pill.classList.toggle('works', !status.share)
    this.pill.classList.toggle('rests', status.share >= 1 && !status.notice && !(status.message && !status.shown))
    this.pill.classList.toggle('error', !status.shown && !!status.message)
    this.help.hidden = !status.help
    if (status.help) {
      this.help.replaceChildren(...status.help.flatMap(([hand, does]) => [make('b', '', hand), make('span', '', does)]))
    }
  }

  showMarks (marks) {
    this.marks.replaceChildren(...marks.flatMap(mark => {
      const rgb = hex(mark.colour)
      if (mark.kind === 'text') {
        const text = document.createElementNS(SVG, 'text')
        text.setAttribute('x', mark.points[0][0]); text.setAttribute('y', mark.points[0][1])
        text.setAttribute('font-size', mark.width); text.setAttribute('fill', rgb)
        text.setAttribute('text-anchor', mark.ends_here ? 'end' : 'start')
        text.textContent = mark.text
        return [text]
      }
      const shape = (extra, fill, stroke, width) => {
        const element = document.createElementNS(SVG, mark.kind === 'dot' ? 'circle' : 'polyline')
        if (mark.kind === 'dot') {
          element.setAttribute('cx', mark.points[0][0]); element.setAttribute('cy', mark.points[0][1])
          element.setAttribute('r', mark.width + extra); element.setAttribute('fill', fill)
        } else {
          element.setAttribute('points', mark.points.map(p => p.join(',')).join(' '))
          element.setAttribute('fill', 'none'); element.setAttribute('stroke', stroke)
          element.setAttribute('stroke-width', width + 2 * extra)
        }
        return element
      }
      return [shape(1.5, '#111214b0', '#111214b0', mark.width), shape(0, rgb, rgb, mark.width)]
    }))
  }

  /* Two fingers move and come nearer; one is the server's mouse. */
  takeTouches () {
    const held = this.touches; let last = null; let waits = false; let sum = null
    const now = () => {
      const [a, b] = [...held.values()]
      return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.max(Math.hypot(a.x - b.x, a.y - b.y), 8) }
    }
    const flush = () => { waits = false; if (sum) { this.send({ type: 'pinch', ...sum }); sum = null } }
    const on = (kind, does) => this.stage.addEventListener(kind, e => {
      if (e.pointerType === 'touch' && e.target.classList.contains('renderview-view')) { does(e) }
    }, true)
    on('pointerdown', e => {
      held.set(e.pointerId, { x: e.clientX, y: e.clientY })
      if (held.size !== 2) { return }
      e.stopPropagation(); last = now()
      this.send({ type: 'pointer_up', x: 0, y: 0, button: 1, buttons: [], modifiers: [], timestamp: performance.now() / 1000 })
    })
    on('pointermove', e => {
      if (held.has(e.pointerId)) { held.set(e.pointerId, { x: e.clientX, y: e.clientY }) }
      if (!last) { return }
      e.stopPropagation()
      if (held.size < 2) { return }
      const next = now(); sum = sum || { dx: 0, dy: 0, scale: 1 }
      sum.dx += next.x - last.x; sum.dy += next.y - last.y; sum.scale *= next.apart / last.apart; last = next
      if (!waits) { waits = true; requestAnimationFrame(flush) }
    })
    const up = e => {
      held.delete(e.pointerId)
      if (held.size === 0) { last = null }
    }
    on('pointerup', up); on('pointercancel', up)
  }

  /* Keys reach the image of a page as soon as there is one, not only once it was clicked. */
  giveKeys () {
    const taker = document.querySelector('#rendercanvas-focus-element-container input')
    if (taker && this.root.classList.contains('page')) { taker.focus({ preventScroll: true }); this.hasHadKeys = true }
  }

  /* Tab is the viewer's while the image has the keys, which the browser would move elsewhere. */
  takeTab () {
    document.addEventListener('keydown', e => {
      const hasKeys = this.stage.querySelector('.has-focus') !== null
      if (e.key === 'Tab' && hasKeys && !(e.shiftKey || e.ctrlKey || e.altKey || e.metaKey)) { e.preventDefault() }
    }, { capture: true, signal: this.ending.signal })
  }

  close () { this.ending.abort() }

  takeFiles () {
    const over = e => { if (e.dataTransfer && [...e.dataTransfer.types].includes('Files')) { e.preventDefault(); this.root.classList.add('dropping') } }
    this.root.addEventListener('dragover', over)
    this.root.addEventListener('dragleave', () => this.root.classList.remove('dropping'))
    this.root.addEventListener('drop', async e => {
      e.preventDefault(); this.root.classList.remove('dropping')
      for (const file of e.dataTransfer.files) { await this.upload(file) }
    })
  }

  async upload (file) {
    const bytes = new Uint8Array(await file.arrayBuffer())
    const parts = Math.max(1, Math.ceil(bytes.length / CHUNK))
    for (let part = 0; part < parts; part++) {
      const piece = bytes.subarray(part * CHUNK, (part + 1) * CHUNK)
      let text = ''
      for (let i = 0; i < piece.length; i += 4096) { text += String.fromCharCode(...piece.subarray(i, i + 4096)) }
      this.send({ type: 'file', name: file.name, part, parts, data: btoa(text) })
      if (part % 32 === 31) { await new Promise(resolve => setTimeout(resolve)) }
    }
  }
}

async function copied (text) {
  try {
    await navigator.clipboard.writeText(text)
  } catch { // a page that is not served securely
    const field = make('textarea'); field.value = text
    document.body.append(field); field.select(); document.execCommand('copy'); field.remove()
  }
}
