"""Lasting stiff contact: Radau IIA against the FMU's exponential collocation (docs/lasting_contact.md)"""
