"""The stability atlas: stiff and extreme scenes over all solver methods, each against an answer known beforehand"""
