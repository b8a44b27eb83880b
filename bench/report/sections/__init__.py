# SPDX-License-Identifier: BSD-3-Clause
"""The sections of the report, one module each."""
