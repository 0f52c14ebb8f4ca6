"""Every FMU in every importer that is installed: end values against those of fmpy (importers)"""
