/* In a browser's page: the panel on the websocket that rendercanvas's client opens. */

const Plain = window.WebSocket
let socket = null
const root = document.getElementById('airlight')
const panel = new AirlightPanel(root, document.getElementById('stage'), message => {
  if (socket && socket.readyState === Plain.OPEN) { socket.send(JSON.stringify(message)) }
}, false)

window.WebSocket = class extends Plain {
  constructor (...given) {
    super(...given)
    socket = this
    this.addEventListener('open', () => panel.hello())
    this.addEventListener('message', e => {
      if (typeof e.data === 'string') {
        const message = JSON.parse(e.data)
        if (message.type === 'active') { root.classList.toggle('looks-on', !message.value) }
        panel.take(message)
      }
    })
  }
}

const status = document.getElementById('status')
const said = new MutationObserver(() => {
  const text = status.innerText
  const isPassive = text.includes('(passive)')
  status.classList.toggle('fine', text.includes('Connected') && !isPassive)
  const note = 'Another tab steers; here you look on.'
  if (isPassive && text !== note) { status.innerText = note }
})
said.observe(status, { childList: true, subtree: true, characterData: true })
