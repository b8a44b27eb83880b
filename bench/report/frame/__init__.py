# SPDX-License-Identifier: BSD-3-Clause
"""What every section of the report stands on."""
