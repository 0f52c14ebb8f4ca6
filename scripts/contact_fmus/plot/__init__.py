"""Results of any scene over time: recorded densely around contacts, drawn as picture or page"""
