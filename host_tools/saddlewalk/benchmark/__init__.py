"""What planning costs, beside its neighbours."""
