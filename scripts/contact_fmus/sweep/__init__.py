"""Studies of many runs of one FMU (command.py): what varies, batches on dask, results as Parquet and CSV"""
