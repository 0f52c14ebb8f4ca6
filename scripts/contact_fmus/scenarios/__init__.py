"""Runs experiments on the contact FMUs and compares them with closed forms"""
