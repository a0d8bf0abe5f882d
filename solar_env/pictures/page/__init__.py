"""HTML pages, each in one file that needs no network, with animated deployments, linked plots and tables.

`content` holds the data of a page as plain numbers; `document` writes the page, with Plotly's library inside; `page.js`
draws the page in the browser. A slider moves arrays, bearings and the cursors of all plots over time.
"""
