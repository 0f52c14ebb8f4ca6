"""A page that plays a run of any scene in three dimensions; it needs nothing from anywhere.

stage.py     what is to be shown: bodies, contacts, samples, and where to look at first
library.py   three.js, which the page carries
page.py      writes the page: page.html, page.css and the scripts in viewer/
command.py   the command animate
"""
