"""Published benchmark impacts beside what the FMUs give (docs/chung-ooi.md)"""
