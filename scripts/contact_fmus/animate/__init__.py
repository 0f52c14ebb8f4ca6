"""A page that plays a run of any scene in three dimensions; it needs nothing from anywhere"""
