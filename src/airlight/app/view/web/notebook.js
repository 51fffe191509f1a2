/* In a notebook's cell: the panel beside rendercanvas's widget. */

export default () => {
  const inner = renderviewModule()
  return {
    initialize: inner.initialize,
    render (ctx) {
      const root = document.createElement('div')
      const stage = document.createElement('div')
      stage.className = 'stage'
      root.append(stage)
      ctx.el.append(root)
      const panel = new AirlightPanel(root, stage, message => ctx.model.send(message), true)
      const take = message => panel.take(message)
      ctx.model.on('msg:custom', take)
      // Keys in the panel are the panel's, not the notebook's.
      panel.panel.addEventListener('keydown', e => e.stopPropagation())
      const view = { ...ctx, el: stage }
      const close = inner.render(view)
      panel.hello()
      return () => { ctx.model.off('msg:custom', take); close(); panel.close() }
    }
  }
}
