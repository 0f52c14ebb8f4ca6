"""Studies of many runs of one FMU (command.py): what varies, batches of runs on dask, results as Parquet and CSV"""
