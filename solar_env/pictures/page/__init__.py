"""Pages: one file of HTML that needs no network, with deployments in motion, linked plots and tables.

`content` says what a page holds, in plain numbers; `document` writes it, with Plotly's library inside; `page.js`
draws it in the browser: a slider moves arrays, bearings and the cursors of all plots over time.
"""
